# The three kinds of target. A file added to a folder is built without another edit: the folders are globbed,
# and CONFIGURE_DEPENDS makes the build look again.

# A floor's device code and its tests; the checkout itself may lie below a folder cuda/.
set(ORACLEGS_DEVICE_FOLDER "/(oraclegs|tests)/[a-z]+/cuda/[^/]+$")

add_library(oraclegs_flags INTERFACE)
# GCC 12 warns falsely about overlapping copies in std::string (GCC bug 105651).
target_compile_options(oraclegs_flags INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Wall;-Wextra;-Wno-restrict;-fno-math-errno>)
if(ORACLEGS_WERROR)
  target_compile_options(oraclegs_flags INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Werror>)
endif()
if(ORACLEGS_SANITIZE)
  target_compile_options(oraclegs_flags INTERFACE -fsanitize=${ORACLEGS_SANITIZE} -fno-omit-frame-pointer)
  target_link_options(oraclegs_flags INTERFACE -fsanitize=${ORACLEGS_SANITIZE})
endif()
target_include_directories(oraclegs_flags INTERFACE ${CMAKE_SOURCE_DIR}/src)

# oraclegs_library(NAME [TORCH] [DEPS floor-or-target...]): the floor src/oraclegs/NAME as target oraclegs::NAME.
# TORCH: may include libtorch, and compiles with its precompiled header.
# What lies in its folder cuda/ belongs to builds with CUDA; all other builds compile it for the emulated device
# (tests/CMakeLists.txt).
function(oraclegs_library name)
  cmake_parse_arguments(ARG "TORCH" "" "DEPS" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/src/oraclegs/${name}/*.cpp)
  if(NOT ORACLEGS_CUDA)
    list(FILTER sources EXCLUDE REGEX "${ORACLEGS_DEVICE_FOLDER}")
  endif()
  add_library(oraclegs_${name} STATIC ${sources})
  add_library(oraclegs::${name} ALIAS oraclegs_${name})
  target_link_libraries(oraclegs_${name} PUBLIC oraclegs_flags ${ARG_DEPS})
  if(ARG_TORCH)
    oraclegs_use_torch(oraclegs_${name})
  endif()
  file(GLOB_RECURSE device_sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/src/oraclegs/${name}/*.cu)
  if(ORACLEGS_CUDA AND device_sources)
    # Objects of their own: neither libtorch's headers and options nor the floors' reach nvcc.
    add_library(oraclegs_${name}_device OBJECT ${device_sources})
    oraclegs_device_code(oraclegs_${name}_device)
    target_sources(oraclegs_${name} PRIVATE $<TARGET_OBJECTS:oraclegs_${name}_device>)
  endif()
  if(ORACLEGS_CUDA)
    oraclegs_tell_of_cuda(${sources})
    target_link_libraries(oraclegs_${name} PRIVATE $<LINK_ONLY:CUDA::cudart_static>)  # no include path
  endif()
endfunction()

# In a build with CUDA, those of the sources that ask for it (#if defined(ORACLEGS_CUDA), or by name: cuda/, gpu_...) are told so
# and find the toolkit's headers. All others have the objects of a build without, which ccache knows. A macro that is
# new in a file is seen when CMake configures.
function(oraclegs_tell_of_cuda)
  set(options -DORACLEGS_CUDA=1)
  foreach(folder ${CUDAToolkit_INCLUDE_DIRS})
    list(APPEND options -isystem ${folder})
  endforeach()
  foreach(source ${ARGN})
    file(STRINGS ${source} asks REGEX "ORACLEGS_CUDA" LIMIT_COUNT 1)
    if(asks OR source MATCHES "${ORACLEGS_DEVICE_FOLDER}|/gpu_[a-z]+.cpp$")
      set_source_files_properties(${source} PROPERTIES COMPILE_OPTIONS "${options}")
    endif()
  endforeach()
endfunction()

# How nvcc compiles the .cu files of a target.
function(oraclegs_device_code target)
  target_include_directories(${target} PRIVATE ${CMAKE_SOURCE_DIR}/src)
  target_compile_definitions(${target} PRIVATE ORACLEGS_CUDA=1)
  # expt-relaxed-constexpr: the shared mathematics calls constexpr functions of the standard library.
  target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CUDA>:--expt-relaxed-constexpr;-lineinfo>)
  if(ORACLEGS_WERROR)
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CUDA>:-Werror=all-warnings>)
  endif()
endfunction()

# Links libtorch and shares the one precompiled header (built once, for the target oraclegs_torch_pch).
function(oraclegs_use_torch target)
  target_link_libraries(${target} PUBLIC oraclegs_torch)
  if(NOT CMAKE_CXX_CLANG_TIDY)
    target_precompile_headers(${target} REUSE_FROM oraclegs_torch_pch)
  endif()
endfunction()
