# Installs the engine into a folder of the build, builds docs/example against it as a user would, and runs it.
# In: BUILD (the engine's build folder), SOURCE (its source folder), GENERATOR, COMPILER.
set(prefix ${BUILD}/test-install)
file(REMOVE_RECURSE ${prefix} ${BUILD}/test-example)
function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE failed OUTPUT_VARIABLE text ERROR_VARIABLE text)
  message("${text}")
  if(failed)
    message(FATAL_ERROR "failed: ${ARGV}")
  endif()
endfunction()
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix})
# nothing that names OpenCL, no instruction set and no private header may be among what is installed
file(GLOB_RECURSE headers ${prefix}/include/*.h)
list(LENGTH headers count)
foreach(header IN LISTS headers)
  file(READ ${header} text)
  if(text MATCHES "cl_|CL/|immintrin|__AVX")
    message(FATAL_ERROR "${header}: names OpenCL or an instruction set")
  endif()
endforeach()
message("${count} public headers")
run(${CMAKE_COMMAND} -S ${SOURCE}/docs/example -B ${BUILD}/test-example -G ${GENERATOR} -DCMAKE_CXX_COMPILER=${COMPILER}
    -DCMAKE_PREFIX_PATH=${prefix} -DCMAKE_BUILD_TYPE=Release)
run(${CMAKE_COMMAND} --build ${BUILD}/test-example)
run(${CMAKE_COMMAND} -E env POCL_CACHE_DIR=${BUILD}/pocl-cache ${BUILD}/test-example/careful_hand)

# README's program as it stands, in a project of the fewest lines: the target brings C++20 along
file(READ ${SOURCE}/README.md readme)
string(REGEX MATCH "```cpp\n([^`]*)```" found "${readme}")
set(program "${CMAKE_MATCH_1}")  # a match begins anew below
if(NOT program MATCHES "int main")
  message(FATAL_ERROR "README.md: no C++ program")
endif()
set(project ${BUILD}/test-readme)
file(REMOVE_RECURSE ${project})
file(WRITE ${project}/main.cpp "${program}")
string(REGEX MATCH "```cmake\n([^`]*)```" found "${readme}")
string(REPLACE "target_link_libraries" "add_executable(my_program main.cpp)\ntarget_link_libraries" lines "${CMAKE_MATCH_1}")
file(WRITE ${project}/CMakeLists.txt "cmake_minimum_required(VERSION 3.25)\nproject(Readme LANGUAGES CXX)\n${lines}")
run(${CMAKE_COMMAND} -S ${project} -B ${project}/build -G ${GENERATOR} -DCMAKE_CXX_COMPILER=${COMPILER}
    -DCMAKE_PREFIX_PATH=${prefix} -DCMAKE_BUILD_TYPE=Release)
run(${CMAKE_COMMAND} --build ${project}/build)
run(${CMAKE_COMMAND} -E env POCL_CACHE_DIR=${BUILD}/pocl-cache ${project}/build/my_program
    ${SOURCE}/assets/scenes/aortic-arch.toml)
