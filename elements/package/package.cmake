# `cmake --install` puts up a package of the layers that need no other library: find_package(bezel) with bezel::shapes,
# bezel::elements and bezel::c, a pkg-config file, the modules and the C header; and the program.
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/bezel)
install(TARGETS bezel_shapes bezel_elements bezel_c EXPORT bezel_targets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
foreach(layer shapes elements c)
  install(DIRECTORY ${CMAKE_BINARY_DIR}/modules/${layer} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/bezel
    COMPONENT development FILES_MATCHING PATTERN "*.mod")
endforeach()
install(FILES elements/c/bezel.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
install(EXPORT bezel_targets NAMESPACE bezel:: DESTINATION ${package_dir} COMPONENT development)
if(TARGET bezel)
  install(TARGETS bezel RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
endif()

# What a linker that is not the Fortran compiler needs beside the archives.
set(runtime ${CMAKE_Fortran_IMPLICIT_LINK_LIBRARIES})
list(REMOVE_ITEM runtime gcc gcc_s c)
list(REMOVE_DUPLICATES runtime)
set(runtime_folders ${CMAKE_Fortran_IMPLICIT_LINK_DIRECTORIES})
list(TRANSFORM runtime PREPEND -l OUTPUT_VARIABLE runtime_flags)
string(REPLACE ";" " " runtime_flags "${runtime_flags}")

configure_package_config_file(elements/package/bezelConfig.cmake.in ${CMAKE_BINARY_DIR}/bezelConfig.cmake
  INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/bezelConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/bezelConfig.cmake ${CMAKE_BINARY_DIR}/bezelConfigVersion.cmake
  DESTINATION ${package_dir} COMPONENT development)

configure_file(elements/package/bezel.pc.in ${CMAKE_BINARY_DIR}/bezel.pc @ONLY)
install(FILES ${CMAKE_BINARY_DIR}/bezel.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
