# The embeddable core as a package: cmake --install build --component haptics --prefix PREFIX, then
# find_package(Sparsha COMPONENTS haptics) and sparsha::haptics.
include(CMakePackageConfigHelpers)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/Sparsha)

set_target_properties(sparsha_base_core PROPERTIES EXPORT_NAME base)
set_target_properties(sparsha_scene_core PROPERTIES EXPORT_NAME scene)
set_target_properties(sparsha_state PROPERTIES EXPORT_NAME state)
set_target_properties(sparsha_haptics PROPERTIES EXPORT_NAME haptics)
install(TARGETS sparsha_base_core sparsha_scene_core sparsha_state sparsha_haptics EXPORT SparshaTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT haptics)
install(EXPORT SparshaTargets NAMESPACE sparsha:: DESTINATION ${package} COMPONENT haptics)

# The headers that tools/check-rooms.py lets the core include.
foreach(folder governor servo state)
  install(DIRECTORY haptics/${folder}/ DESTINATION ${SPARSHA_INSTALL_INCLUDE}/haptics/${folder} COMPONENT haptics
    FILES_MATCHING PATTERN "*.h")
endforeach()
install(FILES haptics/surface/monge_surface.h DESTINATION ${SPARSHA_INSTALL_INCLUDE}/haptics/surface COMPONENT haptics)
install(FILES haptics/proxy/proxy.h DESTINATION ${SPARSHA_INSTALL_INCLUDE}/haptics/proxy COMPONENT haptics)
install(FILES haptics/device/device.h
  DESTINATION ${SPARSHA_INSTALL_INCLUDE}/haptics/device COMPONENT haptics)
install(FILES haptics/device/simulated/exploration_script.h haptics/device/simulated/simulated_device.h
  DESTINATION ${SPARSHA_INSTALL_INCLUDE}/haptics/device/simulated COMPONENT haptics)
install(FILES base/error.h DESTINATION ${SPARSHA_INSTALL_INCLUDE}/base COMPONENT haptics)
install(FILES scene/depth_grid.h scene/workspace.h scene/region_frame.h scene/haptics_config.h
  DESTINATION ${SPARSHA_INSTALL_INCLUDE}/scene COMPONENT haptics)

configure_package_config_file(cmake/SparshaConfig.cmake.in ${CMAKE_BINARY_DIR}/SparshaConfig.cmake
  INSTALL_DESTINATION ${package})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/SparshaConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/SparshaConfig.cmake ${CMAKE_BINARY_DIR}/SparshaConfigVersion.cmake
  DESTINATION ${package} COMPONENT haptics)

# The whole program: cmake --install build --component program.
install(TARGETS sparsha RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
