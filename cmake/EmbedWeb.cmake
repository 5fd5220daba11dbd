# oraclegs_embed_web(TARGET): bundles the pages of web/ with esbuild while building and compiles their bytes into a target as
#   std::span<const oraclegs::EmbeddedFile> oraclegs::EmbeddedWebFiles();   (src/oraclegs/web/embedded.h)
# Without node_modules the span is empty, and everything else is built all the same.
find_program(ORACLEGS_NODE NAMES node nodejs DOC "Node.js 18 or newer, which bundles the pages of web/")

function(oraclegs_embed_web target)
  set(web ${CMAKE_SOURCE_DIR}/web)
  set(out ${CMAKE_BINARY_DIR}/web)
  set(names viewer.html viewer.js viewer.css report.html report.js report.css)
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
    # The linker makes an object of the bytes: a C array of three megabytes takes a compiler minutes.
    add_custom_command(
      OUTPUT ${out}/pages.o
      COMMAND ${CMAKE_LINKER} -r -z noexecstack -b binary -o pages.o ${names}
      DEPENDS ${pages} WORKING_DIRECTORY ${out} VERBATIM)
    set_source_files_properties(${out}/pages.o PROPERTIES EXTERNAL_OBJECT ON GENERATED ON)
    target_sources(${target} PRIVATE ${out}/pages.o)
    foreach(name ${names})
      string(MAKE_C_IDENTIFIER ${name} symbol)
      string(APPEND symbols "extern const char _binary_${symbol}_start[], _binary_${symbol}_end[];\n")
      string(APPEND rows "      {\"${name}\", _binary_${symbol}_start, _binary_${symbol}_end},\n")
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
