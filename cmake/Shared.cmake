# The engine as one shared library: all that the command and the Python extension have in common, compiled once and packaged once.
set(SELDINGER_VARIANTS "" CACHE STRING "Processor levels that get a shared library of their own, as x86-64-v3")
set(parts seldinger_batch seldinger_models seldinger_plan seldinger_session ${lab_parts})
if(TARGET seldinger_view)
  list(APPEND parts seldinger_view seldinger_xray)
endif()
list(TRANSFORM parts REPLACE "(.+)" "$<TARGET_OBJECTS:\\1>" OUTPUT_VARIABLE part_objects)

function(seldinger_shared_library target loops)
  add_library(${target} SHARED $<TARGET_OBJECTS:${loops}> $<TARGET_OBJECTS:seldinger> ${part_objects})
  # the first two numbers are in the file's name, which is its soname too: a wheel has no links
  set(version ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  set_target_properties(${target} PROPERTIES OUTPUT_NAME seldinger EXPORT_NAME seldinger LINKER_LANGUAGE CXX VERSION ${version} SOVERSION ${version})
  if(CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
    target_sources(${target} PRIVATE ${CMAKE_SOURCE_DIR}/cmake/hypot.cpp)
    target_link_options(${target} PRIVATE -Wl,--wrap=hypot)
  endif()
  target_link_libraries(${target} PRIVATE ${engine_libraries})
  if(TARGET seldinger_view)
    target_link_libraries(${target} PRIVATE PkgConfig::EPOXY PkgConfig::FREETYPE PkgConfig::XRAYLIB)
  endif()
endfunction()

seldinger_shared_library(seldinger_shared seldinger_loops)
target_include_directories(seldinger_shared PUBLIC
  "$<BUILD_INTERFACE:${engine_rooms}>" $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}/engine/include/seldinger>
  "$<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}/engine/pictures;${CMAKE_SOURCE_DIR}/engine/studies;${CMAKE_SOURCE_DIR}/engine/live>"
  $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}/kernels> $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}/bench>
  $<INSTALL_INTERFACE:include> $<INSTALL_INTERFACE:include/seldinger>)
target_compile_features(seldinger_shared PUBLIC cxx_std_20)
target_compile_definitions(seldinger_shared PUBLIC ${eigen_alignment} INTERFACE $<BUILD_INTERFACE:CL_TARGET_OPENCL_VERSION=120>)
target_link_libraries(seldinger_shared PUBLIC Eigen3::Eigen)

# The library again for newer processors: the files with loops over nodes are compiled for them, the others are the same objects. glibc
# takes the best that the processor can run from the folder glibc-hwcaps beside the plain library; before glibc 2.33, the plain one.
# All give the same bits.
foreach(variant IN LISTS SELDINGER_VARIANTS)
  seldinger_loop_library(seldinger_loops_${variant})
  target_compile_options(seldinger_loops_${variant} PRIVATE -march=${variant})
  seldinger_shared_library(seldinger_${variant} seldinger_loops_${variant})
  set_target_properties(seldinger_${variant} PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/glibc-hwcaps/${variant})
endforeach()
