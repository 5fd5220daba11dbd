#pragma once
// Answers of the server as a function of the request: refused requests, paths, and the headers that restrict what a
// browser may do with an answer.

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "oraclegs/web/file_below.h"
#include "oraclegs/web/site.h"

namespace oraclegs {

struct WebRequest {
  std::string method;
  std::string path;       ///< decoded, without the query
  std::string host;       ///< header Host
  int hosts = 1;          ///< number of Host headers
  std::string known_tag;  ///< header If-None-Match
};

struct WebAnswer {
  int status = 200;
  std::map<std::string, std::string> headers;
  std::string type = {};  ///< MIME type of the body or file
  std::string body = {};
  std::optional<FileBelow> file = {};  ///< sent instead of the body
};

/// Names by which the server may be addressed. A page of another site can make a browser send requests here under a
/// name that its owner resolves to this machine; such a name is not among them.
class AllowedHosts {
 public:
  /// Allows the names of `host`, to which the server is bound. For a wildcard: every IP address and this machine's
  /// name.
  AllowedHosts(const std::string& host, int port);
  bool Allows(const std::string& header) const;

 private:
  std::string host_, port_, machine_;
  bool wildcard_ = false;
};

/// Whether the host is 0.0.0.0, :: or empty.
bool IsWildcard(const std::string& host);
/// Whether only this machine can reach the host.
bool IsLoopback(const std::string& host);

/// The answer to a request: GET and HEAD of /, /assets/NAME, /api/document, /api/live, /api/ping and /files/PATH.
WebAnswer AnswerTo(const WebRequest& request, const AllowedHosts& hosts, Site* site);

}  // namespace oraclegs
