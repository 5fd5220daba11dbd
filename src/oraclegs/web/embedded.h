#pragma once
// The table of the embedded web pages; cmake/EmbedWeb.cmake writes its source.

#include <span>
#include <string_view>

namespace oraclegs {

/// A file whose bytes are part of the program: [begin, end).
struct EmbeddedFile {
  std::string_view name;  ///< "viewer.html"
  const char* begin = nullptr;
  const char* end = nullptr;
};

/// All embedded files; none when the pages were not built.
std::span<const EmbeddedFile> EmbeddedWebFiles();

}  // namespace oraclegs
