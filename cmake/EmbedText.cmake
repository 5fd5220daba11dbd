# oraclegs_embed_text(TARGET FUNCTION FILES...): compiles text files into a target as
#   std::string_view oraclegs::FUNCTION(std::string_view stem);        empty when there is no file of that stem
#   std::vector<std::string_view> oraclegs::FUNCTIONNames();           the stems
function(oraclegs_embed_text target function)
  set(cases "")
  set(names "")
  foreach(file ${ARGN})
    file(READ ${file} text)
    cmake_path(GET file STEM LAST_ONLY stem)
    string(APPEND cases "  if (stem == \"${stem}\") return R\"text(${text})text\";\n")
    string(APPEND names "\"${stem}\", ")
  endforeach()
  set(out ${CMAKE_CURRENT_BINARY_DIR}/${function}.cpp)
  file(CONFIGURE OUTPUT ${out} @ONLY CONTENT
"// Made by cmake/EmbedText.cmake.
#include <string_view>
#include <vector>

namespace oraclegs {
std::string_view @function@(std::string_view stem);
std::string_view @function@(std::string_view stem) {
@cases@  return {};
}
std::vector<std::string_view> @function@Names();
std::vector<std::string_view> @function@Names() { return {@names@}; }
}  // namespace oraclegs
")
  target_sources(${target} PRIVATE ${out})
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${ARGN})
endfunction()
