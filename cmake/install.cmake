# What other programs embed, as a package of two components:
#   cmake --install build --component haptics --prefix PREFIX; find_package(Sparsha COMPONENTS haptics): sparsha::haptics
#   and then cmake --install build --component pcl --prefix PREFIX; find_package(Sparsha COMPONENTS pcl): sparsha::pcl
include(CMakePackageConfigHelpers)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/Sparsha)

# sparsha_require_built(component target [BY name]): installing says what is to be built first, by another target's name where
# the target's own means two files.
function(sparsha_require_built component target)
  cmake_parse_arguments(ARG "" "BY" "" ${ARGN})
  if(NOT ARG_BY)
    set(ARG_BY ${target})
  endif()
  install(CODE "if(NOT EXISTS \"$<TARGET_FILE:${target}>\")
    message(FATAL_ERROR \"the component ${component} is not built; first: cmake --build ${CMAKE_BINARY_DIR} --target ${ARG_BY}\")
  endif()" COMPONENT ${component})
endfunction()
sparsha_require_built(haptics sparsha_haptics)
if(SPARSHA_COMPONENTS STREQUAL "all")
  sparsha_require_built(pcl sparsha_for_pcl)
  sparsha_require_built(program sparsha BY sparsha_runnable)
endif()

# sparsha_package(component export-set NAME target...): the libraries, under sparsha::NAME.
function(sparsha_package component set)
  list(LENGTH ARGN count)
  math(EXPR last "${count} - 1")
  foreach(i RANGE 0 ${last} 2)
    math(EXPR next "${i} + 1")
    list(GET ARGN ${i} name)
    list(GET ARGN ${next} target)
    set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
    add_library(sparsha::${name} ALIAS ${target})  # the same name for those who use add_subdirectory
    install(TARGETS ${target} EXPORT ${set} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${component})
  endforeach()
  install(EXPORT ${set} NAMESPACE sparsha:: DESTINATION ${package} COMPONENT ${component})
endfunction()

# sparsha_headers(component): the headers that tools/rooms.json lists for it. Those that others include go to include/sparsha,
# what these stand on below its `detail`. What headers of the core include is checked there (tools/rooms.py --check).
file(READ ${PROJECT_SOURCE_DIR}/tools/rooms.json rooms)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/tools/rooms.json)
function(sparsha_headers component)
  string(JSON count LENGTH "${rooms}" installed ${component})
  math(EXPR last "${count} - 1")
  foreach(i RANGE 0 ${last})
    string(JSON pattern GET "${rooms}" installed ${component} ${i})
    file(GLOB found RELATIVE ${PROJECT_SOURCE_DIR} CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${pattern})
    foreach(header ${found})
      get_filename_component(folder ${header} DIRECTORY)
      if(folder MATCHES "^(include/)?(sparsha.*)$")
        set(folder ${CMAKE_INSTALL_INCLUDEDIR}/${CMAKE_MATCH_2})
      else()
        set(folder ${SPARSHA_INSTALL_INCLUDE}/${folder})
      endif()
      install(FILES ${PROJECT_SOURCE_DIR}/${header} DESTINATION ${folder} COMPONENT ${component})
    endforeach()
  endforeach()
endfunction()

# Headers that moved are included by their earlier names as well, until 0.2: a file a name, below `detail` as the headers are.
function(sparsha_moved_headers component)
  string(JSON count LENGTH "${rooms}" moved)
  math(EXPR last "${count} - 1")
  foreach(i RANGE 0 ${last})
    string(JSON earlier MEMBER "${rooms}" moved ${i})
    string(JSON now GET "${rooms}" moved ${earlier})
    file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/earlier/${earlier} @ONLY
      CONTENT "// Goes away with version 0.2.\n#pragma once\n\n#include \"@now@\"\n")
    get_filename_component(folder ${earlier} DIRECTORY)
    install(FILES ${PROJECT_BINARY_DIR}/earlier/${earlier} DESTINATION ${SPARSHA_INSTALL_INCLUDE}/${folder} COMPONENT ${component})
  endforeach()
endfunction()

# What both components stand on belongs to the first: CMake exports a target once.
sparsha_package(haptics SparshaCoreTargets base sparsha_base_core scene sparsha_scene_core)
sparsha_package(haptics SparshaHapticsTargets state sparsha_state haptics sparsha_haptics)
sparsha_headers(haptics)
sparsha_moved_headers(haptics)

if(SPARSHA_COMPONENTS STREQUAL "all")
  # Templates over PCL's point types, and what they are built on.
  sparsha_package(pcl SparshaPclTargets scan sparsha_scan_core filter sparsha_filter_core projection sparsha_projection
    pcl sparsha_for_pcl)
  sparsha_headers(pcl)
endif()

configure_package_config_file(cmake/SparshaConfig.cmake.in ${PROJECT_BINARY_DIR}/SparshaConfig.cmake
  INSTALL_DESTINATION ${package})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/SparshaConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/SparshaConfig.cmake ${PROJECT_BINARY_DIR}/SparshaConfigVersion.cmake
  DESTINATION ${package} COMPONENT haptics)

if(SPARSHA_COMPONENTS STREQUAL "haptics")
  return()
endif()
# The whole program: cmake --install build --component program.
install(TARGETS sparsha RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
if(TARGET sparsha_program)
  install(TARGETS sparsha_program RUNTIME DESTINATION ${CMAKE_INSTALL_LIBDIR}/sparsha COMPONENT program)
endif()
if(TARGET sparsha_mpi)  # a component of its own: the program's package is not to need MPI
  install(TARGETS sparsha_mpi LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/sparsha COMPONENT mpi)
endif()
if(TARGET sparsha_opencv_images)
  install(TARGETS sparsha_opencv_images LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/sparsha COMPONENT program)
endif()
# Read there when the prefix is /usr or /usr/local.
install(FILES haptics/device/falcon/40-novint-falcon.rules DESTINATION lib/udev/rules.d COMPONENT program)
