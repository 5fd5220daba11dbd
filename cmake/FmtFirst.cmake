# PyTorch's wheels bring headers of an fmt of their own, newer than the libfmt that we link, and the compiler would find them
# first. A folder with a link to ours goes before.
get_target_property(fmt_headers fmt::fmt INTERFACE_INCLUDE_DIRECTORIES)
foreach(folder ${TORCH_INCLUDE_DIRS})
  if(EXISTS ${folder}/fmt/format.h AND NOT folder IN_LIST fmt_headers)
    find_path(ORACLEGS_FMT_HEADERS fmt/format.h HINTS ${fmt_headers} NO_DEFAULT_PATH REQUIRED)
    file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/fmt_first)
    file(CREATE_LINK ${ORACLEGS_FMT_HEADERS}/fmt ${CMAKE_BINARY_DIR}/fmt_first/fmt SYMBOLIC)
    target_include_directories(oraclegs_flags SYSTEM BEFORE INTERFACE ${CMAKE_BINARY_DIR}/fmt_first)
  endif()
endforeach()
