# cmake -DOUTPUT=file -DMAIN=file -DFOLDERS=a;b -P single_source.cmake: all modules that MAIN needs, and it, in one file of
# free form. Abaqus takes a .for for fixed form unless it begins as this one does.

function(add_source path)
  file(READ ${path} text)
  string(REGEX MATCHALL "\n *use +[a-z_0-9]+" uses "${text}")
  foreach(use IN LISTS uses)
    string(REGEX REPLACE "\n *use +" "" module ${use})
    get_property(known GLOBAL PROPERTY known_${module})
    if(known)
      continue()
    endif()
    set_property(GLOBAL PROPERTY known_${module} ON)
    foreach(folder IN LISTS FOLDERS)
      if(EXISTS ${folder}/${module}.f90)
        add_source(${folder}/${module}.f90)
      endif()
    endforeach()
  endforeach()
  get_filename_component(name ${path} NAME)
  file(APPEND ${OUTPUT}.new "\n! ---- ${name}\n")
  file(APPEND ${OUTPUT}.new "${text}")
endfunction()

file(WRITE ${OUTPUT}.new "!DIR$ FREEFORM
! Bezel's user elements for Abaqus/Standard: UEL and UEXTERNALDB. Written from the sources; do not edit.\n")
add_source(${MAIN})
file(RENAME ${OUTPUT}.new ${OUTPUT})
