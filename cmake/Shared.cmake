# The engine as one shared library: all that the command and the Python extension have in common, compiled once and packaged once.
set(parts seldinger seldinger_study seldinger_session seldinger_baselines seldinger_roofline)
if(TARGET seldinger_view)
  list(APPEND parts seldinger_view)
endif()
list(TRANSFORM parts REPLACE "(.+)" "$<TARGET_OBJECTS:\\1>" OUTPUT_VARIABLE part_objects)
add_library(seldinger_shared SHARED ${part_objects})
if(CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
  target_sources(seldinger_shared PRIVATE cmake/hypot.cpp)
  target_link_options(seldinger_shared PRIVATE -Wl,--wrap=hypot)
endif()
# the whole version in the file's name, which is its soname too: a wheel has no links
set_target_properties(seldinger_shared PROPERTIES OUTPUT_NAME seldinger EXPORT_NAME seldinger LINKER_LANGUAGE CXX
  VERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
target_include_directories(seldinger_shared PUBLIC
  $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}/engine> $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}/kernels> $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}/bench>
  $<INSTALL_INTERFACE:include> $<INSTALL_INTERFACE:include/seldinger>)
target_compile_features(seldinger_shared PUBLIC cxx_std_20)
target_compile_definitions(seldinger_shared PUBLIC ${eigen_alignment} INTERFACE $<BUILD_INTERFACE:CL_TARGET_OPENCL_VERSION=120>)
target_link_libraries(seldinger_shared PUBLIC Eigen3::Eigen
  PRIVATE OpenCL::OpenCL fmt::fmt tomlplusplus::tomlplusplus pugixml::pugixml ZLIB::ZLIB Threads::Threads TBB::tbb PNG::PNG)
if(TARGET seldinger_view)
  target_link_libraries(seldinger_shared PRIVATE PkgConfig::EPOXY PkgConfig::FREETYPE PkgConfig::XRAYLIB)
endif()
