include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
install(TARGETS seldinger EXPORT SeldingerTargets ARCHIVE LIBRARY RUNTIME)
if(TARGET seldinger_app)
  install(TARGETS seldinger_app RUNTIME)
endif()
install(DIRECTORY engine/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/seldinger FILES_MATCHING PATTERN "*.h" PATTERN "view" EXCLUDE)
install(DIRECTORY kernels/shared DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/seldinger FILES_MATCHING PATTERN "*.h")
install(EXPORT SeldingerTargets NAMESPACE Seldinger:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/Seldinger)
configure_package_config_file(cmake/SeldingerConfig.cmake.in ${CMAKE_BINARY_DIR}/SeldingerConfig.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/Seldinger)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/SeldingerConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/SeldingerConfig.cmake ${CMAKE_BINARY_DIR}/SeldingerConfigVersion.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/Seldinger)
