# The three kinds of target. A file added to a folder is built without another edit: the folders are globbed,
# and CONFIGURE_DEPENDS makes the build look again.

add_library(oraclegs_flags INTERFACE)
# GCC 12 warns falsely about overlapping copies in std::string (GCC bug 105651).
target_compile_options(oraclegs_flags INTERFACE -Wall -Wextra -Wno-restrict -fno-math-errno)
if(ORACLEGS_WERROR)
  target_compile_options(oraclegs_flags INTERFACE -Werror)
endif()
if(ORACLEGS_SANITIZE)
  target_compile_options(oraclegs_flags INTERFACE -fsanitize=${ORACLEGS_SANITIZE} -fno-omit-frame-pointer)
  target_link_options(oraclegs_flags INTERFACE -fsanitize=${ORACLEGS_SANITIZE})
endif()
target_include_directories(oraclegs_flags INTERFACE ${CMAKE_SOURCE_DIR}/src)

# oraclegs_library(NAME [TORCH] [DEPS floor-or-target...]): the floor src/oraclegs/NAME as target oraclegs::NAME.
# TORCH: may include libtorch, and compiles with its precompiled header.
function(oraclegs_library name)
  cmake_parse_arguments(ARG "TORCH" "" "DEPS" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/src/oraclegs/${name}/*.cpp)
  add_library(oraclegs_${name} STATIC ${sources})
  add_library(oraclegs::${name} ALIAS oraclegs_${name})
  target_link_libraries(oraclegs_${name} PUBLIC oraclegs_flags ${ARG_DEPS})
  if(ARG_TORCH)
    oraclegs_use_torch(oraclegs_${name})
  endif()
endfunction()

# Links libtorch and shares the one precompiled header (built once, for the target oraclegs_torch_pch).
function(oraclegs_use_torch target)
  target_link_libraries(${target} PUBLIC oraclegs_torch)
  if(NOT CMAKE_CXX_CLANG_TIDY)
    target_precompile_headers(${target} REUSE_FROM oraclegs_torch_pch)
  endif()
endfunction()
