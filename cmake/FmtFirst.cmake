# PyTorch's wheels bring headers of an fmt of their own, newer than the libfmt that we link, and the compiler would find them
# first. A folder with a link to ours goes before.
foreach(folder ${TORCH_INCLUDE_DIRS})
  if(EXISTS ${folder}/fmt/format.h AND NOT folder STREQUAL "/usr/include")
    find_path(FMT_HEADERS fmt/format.h PATHS /usr/include /usr/local/include NO_DEFAULT_PATH REQUIRED)
    file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/fmt_first)
    file(CREATE_LINK ${FMT_HEADERS}/fmt ${CMAKE_BINARY_DIR}/fmt_first/fmt SYMBOLIC)
    target_include_directories(oraclegs_flags SYSTEM BEFORE INTERFACE ${CMAKE_BINARY_DIR}/fmt_first)
  endif()
endforeach()
