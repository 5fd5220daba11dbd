#pragma once
// Files of a report: OUT/report/.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "oraclegs/image/image.h"

namespace oraclegs {

/// Writes below OUT/report/ and returns the reference to the file for the document: {"url": path relative to OUT}.
/// Throws RunError.
class ReportFiles {
 public:
  /// `root` is that of the workspace.
  explicit ReportFiles(std::filesystem::path root) : root_(std::move(root)) {}

  /// Writes OUT/report/images/NAME.jpg, reduced to at most 960 pixels a side; 1 or 3 channels.
  nlohmann::json Image(const std::string& name, const Image8& image) const;
  /// Writes an image like Image, reduced to at most 200 pixels a side.
  nlohmann::json Thumbnail(const std::string& name, const Image8& image) const;
  /// Writes OUT/report/NAME.
  nlohmann::json Bytes(const std::string& name, std::string_view bytes) const;

 private:
  std::filesystem::path root_;
};

/// Document in which each {"url": ...} holds the content of its file as a data: URI. Throws InputError for a file that
/// is missing.
nlohmann::json WithFilesInside(const nlohmann::json& document, const std::filesystem::path& root);

}  // namespace oraclegs
