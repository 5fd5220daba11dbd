# Device code: FLOOR/cuda/*_test.cpp and *_test.cu. In a build with CUDA on the device, in all others on an emulated one
# (support/emulated_cuda), for which every .cu file is compiled as C++.
file(GLOB cuda_tests CONFIGURE_DEPENDS */cuda/*_test.cpp)
file(GLOB cuda_device_tests CONFIGURE_DEPENDS */cuda/*_test.cu)
if(ORACLEGS_CUDA)
  add_library(oraclegs_cuda_device_tests OBJECT ${cuda_device_tests})
  oraclegs_device_code(oraclegs_cuda_device_tests)
  target_include_directories(oraclegs_cuda_device_tests PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
  target_include_directories(oraclegs_cuda_device_tests SYSTEM PRIVATE
                             $<TARGET_PROPERTY:GTest::gtest,INTERFACE_INCLUDE_DIRECTORIES>)
else()
  file(GLOB device_code CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/src/oraclegs/*/cuda/*.cu)
  list(FILTER device_code EXCLUDE REGEX "/sort_scan.cu$")  # calls CUB
  set_source_files_properties(${device_code} ${cuda_device_tests} PROPERTIES LANGUAGE CXX)
  add_library(oraclegs_emulated_kernels OBJECT ${device_code})
  add_library(oraclegs_cuda_device_tests OBJECT ${cuda_device_tests})
  foreach(target oraclegs_emulated_kernels oraclegs_cuda_device_tests)
    target_compile_options(${target} PRIVATE -xc++)
    target_compile_definitions(${target} PRIVATE __CUDACC__)
    target_link_libraries(${target} PRIVATE oraclegs_emulated_cuda_flags)
    set_target_properties(${target} PROPERTIES UNITY_BUILD OFF)  # the emulation has its own idea of what a translation unit is
  endforeach()
  file(GLOB cuda_host_code CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/src/oraclegs/*/cuda/*.cpp support/emulated_cuda/*.cpp)
  list(APPEND cuda_host_code $<TARGET_OBJECTS:oraclegs_emulated_kernels>)
  add_library(oraclegs_emulated_cuda_flags INTERFACE)
  target_include_directories(oraclegs_emulated_cuda_flags BEFORE INTERFACE ${CMAKE_CURRENT_SOURCE_DIR}/support/emulated_cuda
                             ${CMAKE_CURRENT_SOURCE_DIR})
  target_compile_definitions(oraclegs_emulated_cuda_flags INTERFACE ORACLEGS_EMULATED_CUDA=1)
  target_compile_options(oraclegs_emulated_cuda_flags INTERFACE -Wno-unknown-pragmas -U_FORTIFY_SOURCE)  # longjmp between stacks
  target_link_libraries(oraclegs_emulated_cuda_flags INTERFACE oraclegs_flags)
endif()
file(GLOB gpu_bench_code CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/bench/gpu_*.cpp)
list(FILTER gpu_bench_code EXCLUDE REGEX "/gpu_bench.cpp$")
file(GLOB gpu_bench_tests CONFIGURE_DEPENDS bench/cuda/*_test.cpp)
set_source_files_properties(${gpu_bench_code} ${gpu_bench_tests} PROPERTIES INCLUDE_DIRECTORIES ${CMAKE_SOURCE_DIR})
add_executable(cuda_tests ${cuda_tests} ${cuda_host_code} ${gpu_bench_code}
                          $<TARGET_OBJECTS:oraclegs_cuda_device_tests>)
target_link_libraries(cuda_tests PRIVATE oraclegs::train oraclegs::propose oraclegs::networks oraclegs_test_support)
if(ORACLEGS_CUDA)
  target_link_libraries(cuda_tests PRIVATE CUDA::cudart)
else()
  target_link_libraries(cuda_tests PRIVATE oraclegs_emulated_cuda_flags)
endif()
if(ORACLEGS_SANITIZE MATCHES "undefined" AND NOT ORACLEGS_CUDA)
  # A device does not forgive what a CPU does. Options of a source come last, after the one that takes the check back.
  set_property(SOURCE ${device_code} ${cuda_device_tests} APPEND PROPERTY COMPILE_OPTIONS -fsanitize=alignment)
endif()
add_test(NAME cuda COMMAND cuda_tests)
if(ORACLEGS_SANITIZE)  # what does not fit into memory is null, as without the sanitizer
  set_tests_properties(cuda PROPERTIES ENVIRONMENT "ASAN_OPTIONS=allocator_may_return_null=1")
endif()
