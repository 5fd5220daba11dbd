# oraclegs_embed_web(TARGET): bundles the pages of web/ with esbuild while building and compiles their bytes into a target as
#   std::span<const oraclegs::EmbeddedFile> oraclegs::EmbeddedWebFiles();   (src/oraclegs/web/embedded.h)
# Without node_modules the span is empty, and everything else is built all the same.
find_program(ORACLEGS_NODE NAMES node nodejs DOC "Node.js 18 or newer, which bundles the pages of web/")

function(oraclegs_embed_web target)
  set(web ${CMAKE_SOURCE_DIR}/web)
  set(out ${CMAKE_BINARY_DIR}/web)
  set(names app.html app.js app.css viewer.html viewer.js viewer.css report.html report.js report.css)
  file(GLOB installed CONFIGURE_DEPENDS ${web}/node_modules/.package-lock.json)  # npm writes it last
  set(symbols "")
  set(rows "")
  if(installed AND ORACLEGS_NODE)
    file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${web}/src/*)
    list(TRANSFORM names PREPEND ${out}/ OUTPUT_VARIABLE pages)
    add_custom_command(
      OUTPUT ${pages}
      COMMAND ${ORACLEGS_NODE} ${web}/build.mjs ${out}
      DEPENDS ${web}/build.mjs ${web}/package.json ${installed} ${sources}
      COMMENT "Bundling the web pages" VERBATIM)
    # The assembler takes the bytes as they are: a C array of three megabytes takes a compiler minutes.
    set(assembly "")
    foreach(name ${names})
      string(MAKE_C_IDENTIFIER ${name} symbol)
      string(APPEND assembly "  .globl page_${symbol}_begin, page_${symbol}_end\n"
                             "page_${symbol}_begin:\n  .incbin \"${out}/${name}\"\npage_${symbol}_end:\n")
    endforeach()
    file(CONFIGURE OUTPUT ${out}/pages.s @ONLY CONTENT
"# Made by cmake/EmbedWeb.cmake.
  .section .rodata
@assembly@  .section .note.GNU-stack, \"\", %progbits
")
    set_source_files_properties(${out}/pages.s PROPERTIES OBJECT_DEPENDS "${pages}")
    target_sources(${target} PRIVATE ${out}/pages.s)
    foreach(name ${names})
      string(MAKE_C_IDENTIFIER ${name} symbol)
      string(APPEND symbols "extern const char page_${symbol}_begin[], page_${symbol}_end[];\n")
      string(APPEND rows "      {\"${name}\", page_${symbol}_begin, page_${symbol}_end},\n")
    endforeach()
  else()
    message(STATUS "Without the viewer and the report: run scripts/bootstrap.sh (or: npm ci --prefix web), then build again.")
  endif()
  set(table "{}")
  if(rows)
    set(table "files")
    set(rows "  static const EmbeddedFile files[] = {\n${rows}  };\n")
  endif()
  file(CONFIGURE OUTPUT ${out}/EmbeddedWebFiles.cpp @ONLY CONTENT
"// Made by cmake/EmbedWeb.cmake.
#include \"oraclegs/web/embedded.h\"

extern \"C\" {
@symbols@}

namespace oraclegs {
std::span<const EmbeddedFile> EmbeddedWebFiles() {
@rows@  return @table@;
}
}  // namespace oraclegs
")
  target_sources(${target} PRIVATE ${out}/EmbeddedWebFiles.cpp)
endfunction()
