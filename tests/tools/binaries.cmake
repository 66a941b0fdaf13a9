# Every binary of the build tree and every installed one, read by tools/check-binaries.py.
# cmake -DBUILD=... -DSOURCE=... -DPYTHON=... [-DGUARDS=HARDENED] [-DCOMMANDS=FILE] [-DMODULES=NAME,NAME] -DWORK=... -P binaries.cmake
# MODULES: libraries and objects that must be among what is read.
file(REMOVE_RECURSE ${WORK})
execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD} --component program --prefix ${WORK}/prefix
  COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
if(EXISTS ${BUILD}/python/sparsha)
  execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD} --component python --prefix ${WORK}/prefix
    COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
endif()
if(GUARDS)
  set(flags --hardened)
endif()
if(COMMANDS)
  list(APPEND flags --commands ${COMMANDS})
endif()
string(REPLACE "," ";" modules "${MODULES}")
foreach(module ${modules})
  list(APPEND flags --with ${module})
endforeach()
file(GLOB folders ${BUILD}/*/CMakeFiles ${BUILD}/*/*/CMakeFiles ${BUILD}/*/*/*/CMakeFiles)
list(FILTER folders EXCLUDE REGEX "/[a-z]+-test/")  # of programs that use the package: not ours
foreach(name bin lib python tests)
  if(EXISTS ${BUILD}/${name})
    list(APPEND folders ${BUILD}/${name})
  endif()
endforeach()
execute_process(COMMAND ${PYTHON} ${SOURCE}/tools/check-binaries.py ${flags} ${folders} ${WORK}/prefix RESULT_VARIABLE code)
file(REMOVE_RECURSE ${WORK})
if(NOT code EQUAL 0)
  message(FATAL_ERROR "binaries with faults are named above")
endif()
