# The engine as one shared library: all that the command and the Python extension have in common, compiled once and packaged once.
set(SELDINGER_VARIANTS "" CACHE STRING "Processor levels that get a shared library of their own, as x86-64-v3")
set(parts seldinger_study seldinger_session seldinger_baselines seldinger_roofline)
if(TARGET seldinger_view)
  list(APPEND parts seldinger_view)
endif()
list(TRANSFORM parts REPLACE "(.+)" "$<TARGET_OBJECTS:\\1>" OUTPUT_VARIABLE part_objects)
set(external OpenCL::OpenCL fmt::fmt tomlplusplus::tomlplusplus nlohmann_json::nlohmann_json pugixml::pugixml ZLIB::ZLIB Threads::Threads
  TBB::tbb PNG::PNG)

function(seldinger_shared_library target)
  add_library(${target} SHARED ${ARGN} ${part_objects})
  # the first two numbers are in the file's name, which is its soname too: a wheel has no links
  set(version ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  set_target_properties(${target} PROPERTIES OUTPUT_NAME seldinger EXPORT_NAME seldinger LINKER_LANGUAGE CXX VERSION ${version} SOVERSION ${version})
  if(CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
    target_sources(${target} PRIVATE ${CMAKE_SOURCE_DIR}/cmake/hypot.cpp)
    target_link_options(${target} PRIVATE -Wl,--wrap=hypot)
  endif()
  target_link_libraries(${target} PRIVATE ${external})
  if(TARGET seldinger_view)
    target_link_libraries(${target} PRIVATE PkgConfig::EPOXY PkgConfig::FREETYPE PkgConfig::XRAYLIB)
  endif()
endfunction()

seldinger_shared_library(seldinger_shared $<TARGET_OBJECTS:seldinger>)
target_include_directories(seldinger_shared PUBLIC
  $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}/engine> $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}/kernels> $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}/bench>
  $<INSTALL_INTERFACE:include> $<INSTALL_INTERFACE:include/seldinger>)
target_compile_features(seldinger_shared PUBLIC cxx_std_20)
target_compile_definitions(seldinger_shared PUBLIC ${eigen_alignment} INTERFACE $<BUILD_INTERFACE:CL_TARGET_OPENCL_VERSION=120>)
target_link_libraries(seldinger_shared PUBLIC Eigen3::Eigen)

# The library again for newer processors: the files with loops over nodes are compiled for them, the others are the same objects. glibc
# takes the best that the processor can run from the folder glibc-hwcaps beside the plain library; before glibc 2.33, the plain one.
# All give the same bits.
set(loop_folders "/engine/(math|rod|solve|wall)/")
foreach(variant IN LISTS SELDINGER_VARIANTS)
  add_library(seldinger_loops_${variant} OBJECT ${loop_sources})
  target_include_directories(seldinger_loops_${variant} PRIVATE engine kernels)
  target_link_libraries(seldinger_loops_${variant} PRIVATE Eigen3::Eigen ${external})
  target_compile_definitions(seldinger_loops_${variant} PRIVATE ${eigen_alignment} CL_TARGET_OPENCL_VERSION=120 SELDINGER_VERSION="${PROJECT_VERSION}")
  seldinger_options(seldinger_loops_${variant})
  target_compile_options(seldinger_loops_${variant} PRIVATE -march=${variant})
  seldinger_precompile(seldinger_loops_${variant} <fmt/format.h> <Eigen/SparseCore> <Eigen/Geometry> <CL/cl.h>)
  seldinger_shared_library(seldinger_${variant} $<TARGET_OBJECTS:seldinger_loops_${variant}>
    "$<FILTER:$<TARGET_OBJECTS:seldinger>,EXCLUDE,${loop_folders}>")
  set_target_properties(seldinger_${variant} PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/glibc-hwcaps/${variant})
endforeach()
