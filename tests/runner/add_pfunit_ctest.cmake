# add_pfunit_ctest(NAME TEST_SOURCES ... [OTHER_SOURCES ...] [LINK_LIBRARIES ...] [LABELS ...] [WORKING_DIRECTORY ...])
#
# The function of pFUnit 4, for the runner of this folder: an executable from .pf files, and a test that runs it.

set(runner ${CMAKE_CURRENT_LIST_DIR})
add_executable(pf_preprocessor ${runner}/pf_preprocessor.f90)
add_library(funit STATIC ${runner}/funit.f90 ${runner}/funit_assertions.f90 ${runner}/funit_exceptions.f90
  ${runner}/funit_suites.f90)
set_target_properties(funit PROPERTIES Fortran_MODULE_DIRECTORY ${CMAKE_BINARY_DIR}/modules/funit)
target_include_directories(funit PUBLIC ${CMAKE_BINARY_DIR}/modules/funit)

function(add_pfunit_ctest name)
  cmake_parse_arguments(arg "" "WORKING_DIRECTORY" "TEST_SOURCES;OTHER_SOURCES;LINK_LIBRARIES;LABELS" ${ARGN})
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "add_pfunit_ctest(${name}): unknown argument ${arg_UNPARSED_ARGUMENTS}")
  endif()
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/${name}.dir)
  file(MAKE_DIRECTORY ${folder})

  set(sources)
  set(declarations)
  set(calls)
  foreach(pf IN LISTS arg_TEST_SOURCES)
    get_filename_component(path ${pf} ABSOLUTE)
    get_filename_component(stem ${pf} NAME_WE)
    add_custom_command(OUTPUT ${folder}/${stem}.F90
      COMMAND pf_preprocessor ${path} ${folder}/${stem}.F90
      DEPENDS ${path} pf_preprocessor
      COMMENT "Preprocessing ${stem}.pf")
    list(APPEND sources ${folder}/${stem}.F90)
    string(APPEND declarations "  type(TestSuite), external :: ${stem}_suite\n")
    string(APPEND calls "  call runner%run(${stem}_suite())\n")
  endforeach()
  file(CONFIGURE OUTPUT ${folder}/driver.f90 @ONLY CONTENT
"program run_tests
  use funit, only: TestSuite, suite_runner
  implicit none
@declarations@  type(suite_runner) :: runner

  call runner%open()
@calls@  call runner%close()
end program run_tests
")

  add_executable(${name} ${sources} ${arg_OTHER_SOURCES} ${folder}/driver.f90)
  set_target_properties(${name} PROPERTIES Fortran_MODULE_DIRECTORY ${folder}/modules)
  target_include_directories(${name} PRIVATE ${folder}/modules)
  target_link_libraries(${name} PRIVATE ${arg_LINK_LIBRARIES} funit)
  if(NOT arg_WORKING_DIRECTORY)
    set(arg_WORKING_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR})
  endif()
  add_test(NAME ${name} COMMAND ${name} --verbose WORKING_DIRECTORY ${arg_WORKING_DIRECTORY})
  if(arg_LABELS)
    set_property(TEST ${name} PROPERTY LABELS ${arg_LABELS})
  endif()
endfunction()
