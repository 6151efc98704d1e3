# Turns kernels/*.cl and kernels/shared/*.h into one C++ file of string literals, so that the program needs no files at run
# time. SEL_KERNEL_DIR in the environment makes the program read a folder instead (engine/device/program.cpp).
function(embed_kernels output)
  set(inputs ${ARGN})
  add_custom_command(
    OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -DOUTPUT=${output} "-DINPUTS=${inputs}" -DROOT=${CMAKE_SOURCE_DIR}/kernels
            -P ${CMAKE_SOURCE_DIR}/cmake/embed_kernels_script.cmake
    DEPENDS ${inputs} ${CMAKE_SOURCE_DIR}/cmake/embed_kernels_script.cmake
    VERBATIM)
endfunction()
