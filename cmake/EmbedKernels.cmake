# Turns kernel files (*.cl and the headers they include) below `root` into one C++ file of string literals, so that the program
# needs no files at run time: seldinger::device::`function`(). SEL_KERNEL_DIR in the environment makes the program read a folder
# instead (engine/base/device/source.cpp).
function(embed_kernels function root output)
  set(inputs ${ARGN})
  add_custom_command(
    OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -DFUNCTION=${function} -DOUTPUT=${output} "-DINPUTS=${inputs}" -DROOT=${root}
            -P ${CMAKE_SOURCE_DIR}/cmake/embed_kernels_script.cmake
    DEPENDS ${inputs} ${CMAKE_SOURCE_DIR}/cmake/embed_kernels_script.cmake
    VERBATIM)
endfunction()
