# The program as it is installed, from an empty folder: what it loads at first use is found there, and named when missing.
# cmake -DBUILD=... -DLIBRARY=lib/sparsha/... -DWORK=... -P installed_program.cmake
file(REMOVE_RECURSE ${WORK})
file(MAKE_DIRECTORY ${WORK})
execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD} --component program --prefix ${WORK}/prefix
  COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)

# A slope of 21 x 21 points, filtered by OpenCV.
foreach(j RANGE 20)
  foreach(i RANGE 20)
    string(APPEND points "${i} ${j} ${i}.5\n")
  endforeach()
endforeach()
file(WRITE ${WORK}/scan.xyz "${points}")
file(WRITE ${WORK}/scan.yaml "scans: [{file: scan.xyz, units: mm}]\ngrid: {spacing_mm: 1}\n"
  "texture: {sigma_space_mm: 2, sigma_range_mm: 1, method: opencv}\n")
set(build ${WORK}/prefix/bin/sparsha build ${WORK}/scan.yaml --out)

execute_process(COMMAND ${build} ${WORK}/scene RESULT_VARIABLE code ERROR_VARIABLE error OUTPUT_QUIET)
if(NOT code EQUAL 0 OR NOT EXISTS ${WORK}/scene/scene.yaml)
  message(FATAL_ERROR "the installed program ended with ${code}:\n${error}")
endif()

if(LIBRARY)
  file(REMOVE ${WORK}/prefix/${LIBRARY})
  execute_process(COMMAND ${build} ${WORK}/none RESULT_VARIABLE code ERROR_VARIABLE error OUTPUT_QUIET)
  cmake_path(GET LIBRARY FILENAME name)
  if(NOT code EQUAL 1 OR NOT error MATCHES "${name}: error: " OR EXISTS ${WORK}/none)
    message(FATAL_ERROR "without ${LIBRARY} the program ended with ${code}:\n${error}")
  endif()
endif()
file(REMOVE_RECURSE ${WORK})
