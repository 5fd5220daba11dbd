#pragma once
// The folder that a server shows: two documents and the files that they name.

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

/// A document to send, and a text that changes with it.
struct SiteDocument {
  std::string json;
  std::string tag;
};

/// A folder with report/run.json and live/state.json, either of which may appear, change or vanish at any time. While
/// one is damaged or half written, its last whole version is used. Safe to call from any thread.
class Site {
 public:
  explicit Site(std::filesystem::path root) : root_(std::move(root)) {}

  /// report/run.json; nullopt until it existed once.
  std::optional<SiteDocument> Document();
  /// live/state.json; nullopt when there is none. A run that claims to go on but has lost its lock is interrupted;
  /// "document" and "document_revision" are those of Document.
  std::optional<SiteDocument> Live();
  /// A file that one of the documents names.
  std::optional<FileBelow> File(std::string_view path);

 private:
  /// The last whole version of a file.
  struct Known {
    std::string tag = {};   ///< tag of the file at the last look
    std::string json = {};  ///< last whole version; "" = none yet
    std::set<std::string> urls = {};
    int revision = 0;  ///< raised by each different whole version
  };

  void Look(const char* path, Known* known) const;
  std::optional<nlohmann::json> LiveState();

  std::filesystem::path root_;
  std::mutex mutex_;
  Known document_, live_;
};

}  // namespace oraclegs
