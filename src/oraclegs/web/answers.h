#pragma once
// Requests and answers of a server, and the headers that restrict what a browser may do with an answer.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "oraclegs/web/file_below.h"

namespace oraclegs {

class Site;

struct WebRequest {
  std::string method;
  std::string path;                                    ///< decoded, without the query
  std::string host;                                    ///< header Host
  int hosts = 1;                                       ///< number of Host headers
  std::string known_tag = {};                          ///< header If-None-Match
  std::string origin = {}, cookie = {};                ///< headers of these names
  std::multimap<std::string, std::string> query = {};  ///< decoded
  std::optional<uint64_t> content_length = {};         ///< size of the body; none: no body, or one of unknown size
  /// Reads the next bytes of the body; below 1 where the client sends no more of it. Empty where nobody may.
  std::function<ptrdiff_t(char* to, size_t count)> read = {};
};

struct WebAnswer {
  int status = 200;
  std::map<std::string, std::string> headers;
  std::string type = {};  ///< MIME type of the body or file
  std::string body = {};
  std::optional<FileBelow> file = {};  ///< sent instead of the body
};

/// A line of text.
WebAnswer PlainAnswer(int status, const std::string& text);

/// A JSON document with a tag that changes with it, or "not modified" when the browser has it.
WebAnswer JsonAnswer(std::string json, const std::string& known_tag);

/// A file of the pages that are part of the program; 404 for others and for the report, which is a template.
WebAnswer AssetAnswer(const std::string& name, const std::string& known_tag);

/// An open file, whose type is known by the end of `name`; nothing becomes a page or a script.
WebAnswer FileAnswer(std::optional<FileBelow> file, const std::string& name, const std::string& known_tag);

/// The parts of a run, as the viewer asks for them: /api/document, /api/live, /api/ping, /assets/NAME and /files/PATH;
/// 404 for other paths.
WebAnswer SiteAnswer(const std::string& path, const std::string& known_tag, Site* site);

/// Who may show an answer in a frame.
enum class Frames { kNobody, kThisServer };

/// The answer with the headers of all answers. A policy that it has already stays.
WebAnswer Restricted(WebAnswer answer, Frames frames);

/// The rest of `path` after `prefix`; nullopt for other paths.
std::optional<std::string> PathAfter(const std::string& path, std::string_view prefix);

}  // namespace oraclegs
