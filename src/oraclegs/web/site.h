#pragma once
// The folder that a server shows: two documents, and the files that they name.

#include <filesystem>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "oraclegs/web/file_below.h"

namespace oraclegs {

/// The plain paths (file_below.h) that are values of "url" anywhere in a document.
std::set<std::string> UrlsOf(const nlohmann::json& document);

/// A document as it is sent, and a text that changes with it.
struct SiteDocument {
  std::string json;
  std::string tag;
};

/// A folder with report/run.json and live/state.json, either of which may come, change or vanish at any time. While
/// one of them is damaged or half there, the last whole one stands for it. Any thread may call.
class Site {
 public:
  explicit Site(std::filesystem::path root) : root_(std::move(root)) {}

  /// report/run.json; nothing as long as there was none.
  std::optional<SiteDocument> Document();
  /// live/state.json; nothing when there is none. A run that says that it goes on but does not hold its lock any more
  /// is interrupted; "document" and "document_revision" are what Document would give.
  std::optional<SiteDocument> Live();
  /// A file that one of the two names.
  std::optional<FileBelow> File(std::string_view path);

 private:
  /// The last whole version of a file.
  struct Known {
    std::string tag = {};   ///< of the file that was looked at last
    std::string json = {};  ///< "" = there was no whole one
    std::set<std::string> urls = {};
    int revision = 0;  ///< raised by every other whole one
  };

  void Look(const char* path, Known* known) const;
  std::optional<nlohmann::json> LiveState();

  std::filesystem::path root_;
  std::mutex mutex_;
  Known document_, live_;
};

}  // namespace oraclegs
