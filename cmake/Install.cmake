# What a user of the engine gets: the library, the command, its scenes, and the public headers: engine.h and what it includes.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(public_headers
  engine.h control.h model.h output.h
  core/error.h core/stage_times.h device/device_info.h math/vec3.h
  rod/rod_view.h rod/wire_spec.h solve/solve_spec.h solve/momentum_balance.h
  contact/contact_row.h contact/contact_spec.h contact/force_per_length.h vessel/centreline.h vessel/vessel_spec.h vessel/wall_mesh.h
  wall/wall_readings.h)
if(SELDINGER_SHARED)
  install(TARGETS seldinger_shared EXPORT SeldingerTargets LIBRARY)
  foreach(variant IN LISTS SELDINGER_VARIANTS)
    install(TARGETS seldinger_${variant} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/glibc-hwcaps/${variant} NAMELINK_SKIP)
  endforeach()
else()
  install(TARGETS seldinger EXPORT SeldingerTargets ARCHIVE LIBRARY RUNTIME)
endif()
if(TARGET seldinger_app)
  install(TARGETS seldinger_app RUNTIME)
endif()
foreach(header IN LISTS public_headers)
  get_filename_component(folder ${header} DIRECTORY)
  install(FILES engine/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/seldinger/${folder})
endforeach()
install(FILES engine/session/hand_packet.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/seldinger/session)  # plain C, for devices
install(DIRECTORY assets/ DESTINATION ${CMAKE_INSTALL_DATADIR}/seldinger)
install(EXPORT SeldingerTargets NAMESPACE Seldinger:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/Seldinger)
set(seldinger_static TRUE)
if(SELDINGER_SHARED)
  set(seldinger_static FALSE)
endif()
configure_package_config_file(cmake/SeldingerConfig.cmake.in ${CMAKE_BINARY_DIR}/SeldingerConfig.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/Seldinger)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/SeldingerConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/SeldingerConfig.cmake ${CMAKE_BINARY_DIR}/SeldingerConfigVersion.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/Seldinger)
include(cmake/Package.cmake)
