# What is installed and packaged: the engine as one shared library, with all that the command and the Python extension have in common, and
# the command that links it. Of the objects of the plain build, so that a symbol that is missing fails there.
set(SELDINGER_VARIANTS "" CACHE STRING "Processor levels that get a shared library of their own, as x86-64-v3")
set(parts seldinger_batch seldinger_models seldinger_plan seldinger_session seldinger_report)
if(SELDINGER_LAB)
  list(APPEND parts ${lab_parts})
endif()
if(SELDINGER_VIEW)
  list(APPEND parts seldinger_view seldinger_xray)
endif()
list(TRANSFORM parts REPLACE "(.+)" "$<TARGET_OBJECTS:\\1>" OUTPUT_VARIABLE part_objects)

function(seldinger_shared_library target loops)
  add_library(${target} SHARED $<TARGET_OBJECTS:${loops}> $<TARGET_OBJECTS:seldinger_files> $<TARGET_OBJECTS:seldinger> ${part_objects})
  # the first two numbers are in the file's name, which is its soname too: a wheel has no links
  set(version ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  set_target_properties(${target} PROPERTIES OUTPUT_NAME seldinger EXPORT_NAME seldinger LINKER_LANGUAGE CXX VERSION ${version} SOVERSION ${version}
    LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/installed)
  target_link_options(${target} PRIVATE -Wl,-Bsymbolic-functions $<$<CONFIG:Release>:-s>)
  if(NOT CMAKE_CXX_FLAGS MATCHES "-fsanitize")
    target_link_options(${target} PRIVATE -Wl,-z,defs)
  endif()
  if(CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
    target_sources(${target} PRIVATE ${CMAKE_SOURCE_DIR}/cmake/hypot.cpp)
    target_link_options(${target} PRIVATE -Wl,--wrap=hypot)
  endif()
  target_link_libraries(${target} PRIVATE ${engine_libraries})
  if(SELDINGER_VIEW)
    target_link_libraries(${target} PRIVATE PkgConfig::EPOXY PkgConfig::FREETYPE PkgConfig::XRAYLIB)
  endif()
endfunction()

seldinger_shared_library(seldinger_shared seldinger_loops)
# its users see no library but it: none of Eigen, none of OpenCL
target_include_directories(seldinger_shared INTERFACE $<INSTALL_INTERFACE:include> $<INSTALL_INTERFACE:include/seldinger>)
target_compile_features(seldinger_shared INTERFACE cxx_std_20)
# an optional library as a component: find_package(Seldinger COMPONENTS pictures), Seldinger::pictures
set(seldinger_components studies live)
if(SELDINGER_ELASTIC)
  list(APPEND seldinger_components elastic)
endif()
if(SELDINGER_VIEW)
  list(APPEND seldinger_components pictures)
endif()
foreach(component IN LISTS seldinger_components)
  add_library(seldinger_component_${component} INTERFACE)
  set_target_properties(seldinger_component_${component} PROPERTIES EXPORT_NAME ${component})
  target_link_libraries(seldinger_component_${component} INTERFACE seldinger_shared)
endforeach()

add_executable(seldinger_command $<TARGET_OBJECTS:seldinger_app>)
set_target_properties(seldinger_command PROPERTIES OUTPUT_NAME seldinger LINKER_LANGUAGE CXX RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/installed)
target_link_libraries(seldinger_command PRIVATE seldinger_shared CLI11::CLI11 fmt::fmt nlohmann_json::nlohmann_json)
target_link_options(seldinger_command PRIVATE $<$<CONFIG:Release>:-s>)

# The library again for newer processors: the files with loops over nodes are compiled for them, the others are the same objects. glibc
# takes the best that the processor can run from the folder glibc-hwcaps beside the plain library; before glibc 2.33, the plain one.
# All give the same bits.
foreach(variant IN LISTS SELDINGER_VARIANTS)
  seldinger_loop_library(seldinger_loops_${variant})
  target_compile_options(seldinger_loops_${variant} PRIVATE -march=${variant})
  seldinger_shared_library(seldinger_${variant} seldinger_loops_${variant})
  set_target_properties(seldinger_${variant} PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/installed/glibc-hwcaps/${variant})
endforeach()
