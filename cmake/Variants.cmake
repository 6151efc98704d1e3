# The shared library once more for each processor level of SELDINGER_VARIANTS (x86-64-v3 ...): builds of their own, so that no inline
# function of one ends up in another. glibc takes the best that the processor can run from the folder glibc-hwcaps beside the plain
# library; before glibc 2.33 it takes the plain one. All give the same bits.
include(ExternalProject)
set(SELDINGER_VARIANTS "" CACHE STRING "Processor levels that get a shared library of their own, as x86-64-v3 (needs SELDINGER_SHARED)")
foreach(variant IN LISTS SELDINGER_VARIANTS)
  set(folder ${CMAKE_BINARY_DIR}/${variant})
  ExternalProject_Add(seldinger_${variant} SOURCE_DIR ${CMAKE_SOURCE_DIR} BINARY_DIR ${folder} BUILD_ALWAYS ON USES_TERMINAL_BUILD ON
    INSTALL_COMMAND "" BUILD_COMMAND ${CMAKE_COMMAND} --build ${folder} --target seldinger_shared
    CMAKE_ARGS -DCMAKE_BUILD_TYPE=${CMAKE_BUILD_TYPE} "-DCMAKE_CXX_FLAGS=${CMAKE_CXX_FLAGS} -march=${variant}" -DSELDINGER_SHARED=ON
      -DSELDINGER_TESTS=OFF -DSELDINGER_VIEW=${SELDINGER_VIEW} -DCMAKE_CXX_COMPILER=${CMAKE_CXX_COMPILER})
  set(library ${folder}/$<TARGET_FILE_NAME:seldinger_shared>)
  install(FILES ${library} DESTINATION ${CMAKE_INSTALL_LIBDIR}/glibc-hwcaps/${variant})
  install(FILES ${library} DESTINATION seldinger/lib/glibc-hwcaps/${variant} COMPONENT python EXCLUDE_FROM_ALL)
endforeach()
