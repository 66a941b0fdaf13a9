# `make package`: Debian packages and a tarball by CPack, from the components of cmake/install.cmake (docs/use/install.md).
set(manual ${CMAKE_BINARY_DIR}/manual)
find_package(Python3 QUIET COMPONENTS Interpreter)
string(TIMESTAMP SPARSHA_RELEASE_DATE "%Y-%m-%d" UTC)  # of SOURCE_DATE_EPOCH, where that is set
set(SPARSHA_MAINTAINER "Sparsha maintainers <maintainers@users.noreply.github.com>" CACHE STRING "Maintainer of the packages")
string(TIMESTAMP SPARSHA_CHANGELOG_DATE "%a, %d %b %Y %H:%M:%S +0000" UTC)
configure_file(packaging/changelog.in ${CMAKE_BINARY_DIR}/packaging/changelog @ONLY)
configure_file(packaging/org.sparsha.sparsha.metainfo.xml.in ${CMAKE_BINARY_DIR}/packaging/org.sparsha.sparsha.metainfo.xml @ONLY)

# Man pages, completion and the schema of configurations are made from what the program says of itself; a build without Python or without the program has none.
add_custom_target(sparsha_manual
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${manual}
  COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/tools/manual.py $<TARGET_FILE:sparsha> ${manual} ${SPARSHA_RELEASE_DATE}
  COMMAND ${CMAKE_COMMAND} -DFOLDER=${manual} -DCHANGES=${CMAKE_BINARY_DIR}/packaging/changelog -P ${PROJECT_SOURCE_DIR}/packaging/compress.cmake
  VERBATIM)
add_dependencies(sparsha_manual sparsha_runnable)
add_custom_target(sparsha_packaged DEPENDS sparsha_runnable sparsha_manual sparsha_haptics sparsha_for_pcl)

# sparsha_share(from to): what is read as it is.
function(sparsha_share from to)
  install(DIRECTORY ${from} DESTINATION ${CMAKE_INSTALL_DATADIR}/${to} COMPONENT program ${ARGN})
endfunction()
sparsha_share(${manual}/man1/ man/man1 OPTIONAL FILES_MATCHING PATTERN "*.gz")
sparsha_share(${manual}/man5/ man/man5 OPTIONAL FILES_MATCHING PATTERN "*.gz")
install(FILES ${manual}/sparsha.schema.json DESTINATION ${CMAKE_INSTALL_DATADIR}/sparsha COMPONENT program OPTIONAL)
install(FILES ${manual}/sparsha.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME sparsha
  COMPONENT program OPTIONAL)
install(FILES ${manual}/_sparsha DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT program OPTIONAL)
install(FILES packaging/sparsha.desktop DESTINATION ${CMAKE_INSTALL_DATADIR}/applications COMPONENT program)
install(FILES packaging/sparsha.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/mime/packages COMPONENT program)
install(FILES packaging/sparsha.svg DESTINATION ${CMAKE_INSTALL_DATADIR}/icons/hicolor/scalable/apps COMPONENT program)
install(FILES ${CMAKE_BINARY_DIR}/packaging/org.sparsha.sparsha.metainfo.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/metainfo
  COMPONENT program)
sparsha_share(configs sparsha PATTERN speech EXCLUDE)  # the languages are compiled in
sparsha_share(data sparsha PATTERN "*.sh" EXCLUDE PATTERN pillars EXCLUDE)
install(FILES CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/sparsha COMPONENT program)
sparsha_share(docs doc/sparsha PATTERN images EXCLUDE)
install(FILES packaging/sparsha.lintian DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides RENAME sparsha COMPONENT program)
set(packages program:sparsha haptics:libsparsha-dev)
if(TARGET sparsha_mpi)
  add_dependencies(sparsha_packaged sparsha_mpi)
  list(APPEND packages mpi:sparsha-mpi)
endif()
# The system's own Python alone has its packages where Debian's tools look for them.
if(TARGET sparsha_python AND SPARSHA_PYTHON_EXECUTABLE STREQUAL "/usr/bin/python3" AND SPARSHA_PYTHON_DIR STREQUAL "lib/python3/dist-packages")
  set(python TRUE)
  add_dependencies(sparsha_packaged sparsha_python_package)
  list(APPEND packages python_system:python3-sparsha)
  include(cmake/python_package.cmake)
endif()
foreach(pair ${packages})
  string(REPLACE ":" ";" pair ${pair})
  list(GET pair 0 component)
  list(GET pair 1 name)
  install(FILES packaging/copyright DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name} COMPONENT ${component})
  install(FILES ${manual}/changelog.gz DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name} COMPONENT ${component} OPTIONAL)
endforeach()
install(DIRECTORY examples DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libsparsha-dev COMPONENT haptics
  PATTERN __pycache__ EXCLUDE)

set(CPACK_GENERATOR DEB TGZ)
set(CPACK_PROJECT_CONFIG_FILE ${PROJECT_SOURCE_DIR}/packaging/archive.cmake)
set(CPACK_PACKAGE_NAME sparsha)
set(CPACK_PACKAGE_VENDOR "the Sparsha authors")
set(CPACK_PACKAGE_CONTACT "${SPARSHA_MAINTAINER}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_COMPONENTS_ALL program haptics pcl)
if(TARGET sparsha_mpi)
  list(APPEND CPACK_COMPONENTS_ALL mpi)
endif()
if(python)
  list(APPEND CPACK_COMPONENTS_ALL python python_system)
endif()
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${SPARSHA_MODULES})

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME sparsha)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
# Loaded by name at run time, or run: OpenGL's dispatch and a driver, fonts, speech.
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "libegl1, libgl1, libopengl0")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "libgl1-mesa-dri, fonts-dejavu-core, espeak-ng")
set(CPACK_DEBIAN_MPI_PACKAGE_NAME sparsha-mpi)
set(CPACK_DEBIAN_MPI_PACKAGE_SECTION science)
set(CPACK_DEBIAN_MPI_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_MPI_PACKAGE_DEPENDS "sparsha (= ${PROJECT_VERSION}), openmpi-bin")
set(CPACK_DEBIAN_MPI_DESCRIPTION "Sparsha's part for MPI, with which `mpirun sparsha build` builds one scene by
several processes, on one machine or many.")
set(CPACK_DEBIAN_DEV_PACKAGE_NAME libsparsha-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "libeigen3-dev")
set(CPACK_DEBIAN_DEV_PACKAGE_SUGGESTS "libpcl-dev, cmake")
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "${CPACK_PACKAGE_CONTACT}")
set(CPACK_DEBIAN_PROGRAM_DESCRIPTION "Turns raw scans of reliefs, statues and buildings into scenes that are
touched with a haptic device, seen and heard, and says how far the touched
surface lies from the points. Made for museums, for visitors without sight
and for research.")
set(CPACK_DEBIAN_DEV_DESCRIPTION "Headers, static libraries, CMake package and examples of the haptic
renderer, which needs Eigen and threads, and of the projection for programs
that use PCL.")

include(CPack)
cpack_add_component_group(program)
cpack_add_component_group(dev)
cpack_add_component_group(mpi)
cpack_add_component(program GROUP program)
cpack_add_component(haptics GROUP dev)
cpack_add_component(pcl GROUP dev)
if(TARGET sparsha_mpi)
  cpack_add_component(mpi GROUP mpi)
endif()
if(python)
  cpack_add_component_group(python)
  cpack_add_component(python GROUP python)
  cpack_add_component(python_system GROUP python)
endif()
