#pragma once
// The files of a report: OUT/report/.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "oraclegs/image/image.h"

namespace oraclegs {

/// Writes below OUT/report/ and names what it wrote as the document does: {"url": path relative to OUT}. Throws
/// RunError.
class ReportFiles {
 public:
  /// `root`: of the workspace.
  explicit ReportFiles(std::filesystem::path root) : root_(std::move(root)) {}

  /// OUT/report/images/NAME.jpg, reduced to at most 960 pixels a side. 1 or 3 channels.
  nlohmann::json Image(const std::string& name, const Image8& image) const;
  /// The same with at most 200 pixels a side.
  nlohmann::json Thumbnail(const std::string& name, const Image8& image) const;
  /// OUT/report/NAME.
  nlohmann::json Bytes(const std::string& name, std::string_view bytes) const;

 private:
  std::filesystem::path root_;
};

/// The document with the content of every file that it names by {"url": ...} in place of the path, as a data: URI.
/// Throws InputError for a file that is missing.
nlohmann::json WithFilesInside(const nlohmann::json& document, const std::filesystem::path& root);

}  // namespace oraclegs
