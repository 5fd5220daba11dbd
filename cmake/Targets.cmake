# The kinds of target. A file added to a folder is built without another edit: the folders are globbed, and
# CONFIGURE_DEPENDS makes the build look again.

# The floors that need no program: what -DORACLEGS_APPS=OFF builds.
set(ORACLEGS_ENGINE core image camera scene demo depth gaussians render loss train propose)

# A floor's device code and its tests; the checkout itself may lie below a folder cuda/.
set(ORACLEGS_DEVICE_FOLDER "/(oraclegs|tests)/[a-z]+/cuda/[^/]+$")

configure_file(${CMAKE_SOURCE_DIR}/cmake/config.h.in ${CMAKE_BINARY_DIR}/generated/oraclegs/core/config.h)

# One set of objects for programs and for the shared libraries; without interposition that costs programs nothing.
add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-fPIC> $<$<COMPILE_LANGUAGE:CXX>:-fno-semantic-interposition>)

add_library(oraclegs_flags INTERFACE)
# GCC 12 warns falsely about overlapping copies in std::string (GCC bug 105651).
target_compile_options(oraclegs_flags INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Wall;-Wextra;-fno-math-errno>
                       $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-restrict>)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(aarch64|arm64)$")
  # ARM always has a fused multiply-add, x86-64 only where Highway asks: results shall not hang on what a compiler fuses.
  # GCC also notes where ARM's calling convention changed between C++14 and C++17.
  # Of Highway's instruction sets one is left, NEON, which all of them have: there is nothing to choose when the program starts.
  # Highway then gives functions no instruction set of their own, which the constructors that GCC writes itself would lack.
  target_compile_options(oraclegs_flags INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-ffp-contract=off>
                         $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-psabi>)
  target_compile_definitions(oraclegs_flags INTERFACE TOOLCHAIN_MISS_SYS_AUXV_H)
endif()
if(ORACLEGS_WERROR)
  target_compile_options(oraclegs_flags INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Werror>)
endif()
if(ORACLEGS_HARDENING)
  # Some compilers set a level of _FORTIFY_SOURCE themselves.
  target_compile_options(oraclegs_flags INTERFACE
                         $<$<COMPILE_LANGUAGE:CXX>:-fstack-protector-strong;-U_FORTIFY_SOURCE;-D_FORTIFY_SOURCE=2>)
  target_link_options(oraclegs_flags INTERFACE LINKER:-z,relro,-z,now)
endif()
if(ORACLEGS_SANITIZE)
  target_compile_options(oraclegs_flags INTERFACE -fsanitize=${ORACLEGS_SANITIZE} -fno-omit-frame-pointer)
  target_link_options(oraclegs_flags INTERFACE -fsanitize=${ORACLEGS_SANITIZE})
  if(ORACLEGS_SANITIZE MATCHES "address.*undefined|undefined.*address")
    # Checks of every access, which double the compile time; the address sanitizer stops most of what they would find.
    target_compile_options(oraclegs_flags INTERFACE -fno-sanitize=null,alignment,object-size,vptr)
    # What is found ends the test or the fuzzer, instead of a line that nobody reads.
    target_compile_options(oraclegs_flags INTERFACE -fno-sanitize-recover=undefined,float-cast-overflow)
  endif()
endif()
target_include_directories(oraclegs_flags INTERFACE ${CMAKE_SOURCE_DIR}/src ${CMAKE_BINARY_DIR}/generated)

# The headers that nearly every file reads and nobody here changes.
add_library(oraclegs_pch STATIC ${CMAKE_SOURCE_DIR}/cmake/pch.cpp)
target_link_libraries(oraclegs_pch PUBLIC oraclegs_flags Eigen3::Eigen fmt::fmt)
target_precompile_headers(oraclegs_pch PRIVATE <Eigen/Core> <Eigen/Geometry> <fmt/format.h> <fmt/ranges.h> <algorithm> <array>
                          <cmath> <filesystem> <functional> <memory> <optional> <string> <vector>)
set_target_properties(oraclegs_pch PROPERTIES CXX_COMPILER_LAUNCHER "${ORACLEGS_CCACHE_OF_HEADERS}")

# Files that Highway compiles once an instruction set share nothing: no translation unit with others (CMAKE_UNITY_BUILD, which
# the presets but dev set: a cold build takes a third of the time), and no precompiled header, after which GCC 12 refuses the
# constants of intrinsics in code that is not optimized.
function(oraclegs_keep_kernels_alone)
  foreach(source ${ARGN})
    file(STRINGS ${source} kernels REGEX "hwy/foreach_target.h" LIMIT_COUNT 1)
    if(kernels)
      set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON SKIP_PRECOMPILE_HEADERS ON)
      if(ORACLEGS_SANITIZE MATCHES "fuzzer")
        # Clang takes minutes a file to count their branches, to check each number and to watch the scope of each lane: of the
        # sanitizers they have the one of addresses.
        set_source_files_properties(
          ${source} PROPERTIES COMPILE_DEFINITIONS ORACLEGS_FEW_HWY_TARGETS COMPILE_OPTIONS
                               "-fno-sanitize=fuzzer-no-link,undefined,float-cast-overflow;-fno-sanitize-address-use-after-scope")
      endif()
    endif()
  endforeach()
endfunction()

# oraclegs_library(NAME [SHARED] DEPS floor-or-target...): the floor src/oraclegs/NAME as target oraclegs::NAME, and a row of
# floors.json, which scripts/check_house.py reads. SOURCES replaces the files of the folder.
# What lies in its folder cuda/ belongs to the library of device code (src/oraclegs/cuda); the tests of builds without nvcc compile
# it for the emulated device (tests/device_tests.cmake).
function(oraclegs_library name)
  cmake_parse_arguments(ARG "SHARED" "" "DEPS;SOURCES" ${ARGN})
  set(sources ${ARG_SOURCES})
  if(NOT sources)
    file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/src/oraclegs/${name}/*.cpp)
  endif()
  list(FILTER sources EXCLUDE REGEX "${ORACLEGS_DEVICE_FOLDER}")
  oraclegs_keep_kernels_alone(${sources})
  set(kind STATIC)
  if(ARG_SHARED)
    set(kind SHARED)
  endif()
  add_library(oraclegs_${name} ${kind} ${sources})
  add_library(oraclegs::${name} ALIAS oraclegs_${name})
  target_link_libraries(oraclegs_${name} PUBLIC $<BUILD_INTERFACE:oraclegs_flags> ${ARG_DEPS})
  oraclegs_use_pch(oraclegs_${name})
  oraclegs_add_floor(${name} ${ARG_DEPS})
endfunction()

# Puts a floor and those it may include from into floors.json.
function(oraclegs_add_floor name)
  list(FILTER ARGN INCLUDE REGEX "^oraclegs::")
  list(TRANSFORM ARGN REPLACE "^oraclegs::(.*)$" "\"\\1\"")
  list(JOIN ARGN ", " below)
  get_property(floors GLOBAL PROPERTY ORACLEGS_FLOORS)
  list(APPEND floors "  {\"name\": \"${name}\", \"uses\": [${below}]}")
  set_property(GLOBAL PROPERTY ORACLEGS_FLOORS "${floors}")
  list(JOIN floors ",\n" rows)
  file(WRITE ${CMAKE_BINARY_DIR}/floors.json "[\n${rows}\n]\n")
endfunction()

# How nvcc compiles the .cu files of a target.
function(oraclegs_device_code target)
  target_include_directories(${target} PRIVATE ${CMAKE_SOURCE_DIR}/src ${CMAKE_BINARY_DIR}/generated)
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON UNITY_BUILD OFF)
  # expt-relaxed-constexpr: the shared mathematics calls constexpr functions of the standard library.
  target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CUDA>:--expt-relaxed-constexpr;-lineinfo>)
  if(ORACLEGS_WERROR)
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CUDA>:-Werror=all-warnings>)
  endif()
endfunction()

# A library of device code: what src/oraclegs/cuda exports, from the objects of `code`.
function(oraclegs_cuda_library target code)
  add_library(${target} MODULE ${CMAKE_SOURCE_DIR}/src/oraclegs/cuda/library.cpp)
  target_link_libraries(${target} PRIVATE ${code})
  add_dependencies(${target} oraclegs_core)  # which makes engine_source.h
  set_target_properties(${target} PROPERTIES UNITY_BUILD OFF)
endfunction()

# Shares the one precompiled header.
function(oraclegs_use_pch target)
  if(NOT CMAKE_CXX_CLANG_TIDY)
    target_precompile_headers(${target} REUSE_FROM oraclegs_pch)
  endif()
endfunction()

# Links libtorch and shares its precompiled header. For the floor networks, its tests and benchmarks.
function(oraclegs_use_torch target)
  target_link_libraries(${target} PUBLIC oraclegs_torch)
  if(NOT CMAKE_CXX_CLANG_TIDY)
    target_precompile_headers(${target} REUSE_FROM oraclegs_torch_pch)
  endif()
endfunction()
