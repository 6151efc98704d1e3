# What a user of the engine gets: the library, the command, its scenes, and the public headers.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
list(TRANSFORM seldinger_components REPLACE "(.+)" "seldinger_component_\\1" OUTPUT_VARIABLE component_targets)
list(JOIN seldinger_components ", " component_names)
# the command finds the library wherever both are put; in a system's own folders the loader knows where
file(RELATIVE_PATH to_library ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBDIR})
if(SKBUILD)
  set(to_library ../lib)  # python/CMakeLists.txt
endif()
if(SKBUILD OR NOT CMAKE_INSTALL_PREFIX STREQUAL "/usr")
  set_target_properties(seldinger_command PROPERTIES INSTALL_RPATH "$ORIGIN/${to_library}")
endif()
install(TARGETS seldinger_shared ${component_targets} EXPORT SeldingerTargets LIBRARY)
foreach(variant IN LISTS SELDINGER_VARIANTS)
  install(TARGETS seldinger_${variant} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/glibc-hwcaps/${variant} NAMELINK_SKIP)
endforeach()
install(TARGETS seldinger_command RUNTIME)
install(DIRECTORY engine/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY assets/ DESTINATION ${CMAKE_INSTALL_DATADIR}/seldinger)
install(EXPORT SeldingerTargets NAMESPACE Seldinger:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/Seldinger)
configure_package_config_file(cmake/SeldingerConfig.cmake.in ${CMAKE_BINARY_DIR}/SeldingerConfig.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/Seldinger)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/SeldingerConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/SeldingerConfig.cmake ${CMAKE_BINARY_DIR}/SeldingerConfigVersion.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/Seldinger)

# man page and completion of the command, of the page that ctest holds to --help
find_package(Python3 COMPONENTS Interpreter)
if(Python3_Interpreter_FOUND)
  set(manual ${CMAKE_BINARY_DIR}/manual)
  add_custom_command(OUTPUT ${manual}/seldinger.1.gz ${manual}/seldinger.bash
    COMMAND ${Python3_EXECUTABLE} ${CMAKE_SOURCE_DIR}/packaging/manual.py ${CMAKE_SOURCE_DIR}/docs/options.md ${PROJECT_VERSION} ${manual}
    DEPENDS packaging/manual.py docs/options.md CMakeLists.txt VERBATIM)
  add_custom_target(seldinger_manual ALL DEPENDS ${manual}/seldinger.1.gz ${manual}/seldinger.bash)
  install(FILES ${manual}/seldinger.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
  install(FILES ${manual}/seldinger.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME seldinger)
else()
  message(STATUS "no Python: the command is installed without man page and completion")
endif()

# programs and scenes that the pages speak of
install(DIRECTORY examples/ DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/seldinger/examples PATTERN __pycache__ EXCLUDE)
install(DIRECTORY docs/example/ DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/seldinger/examples/cpp)

# Pages of the site, as ./dev docs makes them
set(SELDINGER_SITE "" CACHE PATH "A folder of the documents' pages that is installed too (empty: none)")
if(SELDINGER_SITE)
  install(DIRECTORY ${SELDINGER_SITE}/ DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/seldinger/html)
endif()
include(cmake/Package.cmake)
