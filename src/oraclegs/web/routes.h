#pragma once
// What the server answers, as a function of the request: which requests it refuses, what is at which path, and the
// headers that keep a browser from doing anything else with it.

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
  int hosts = 1;          ///< how many such headers there are
  std::string known_tag;  ///< header If-None-Match
};

struct WebAnswer {
  int status = 200;
  std::map<std::string, std::string> headers;
  std::string type = {};  ///< MIME type of what follows
  std::string body = {};
  std::optional<FileBelow> file = {};  ///< sent instead of the body
};

/// Names by which the server may be asked. A page of another site can make a browser send requests here by a name that
/// its owner lets point to this machine; such a name is not among them.
class AllowedHosts {
 public:
  /// `host`: what the server is bound to. Of a wildcard, every IP address and this machine's name are allowed.
  AllowedHosts(const std::string& host, int port);
  bool Allows(const std::string& header) const;

 private:
  std::string host_, port_, machine_;
  bool wildcard_ = false;
};

/// True for 0.0.0.0, :: and an empty name.
bool IsWildcard(const std::string& host);
/// True for names and addresses that only this machine can reach.
bool IsLoopback(const std::string& host);

/// The answer to a request: GET and HEAD of /, /assets/NAME, /api/document, /api/live, /api/ping and /files/PATH.
WebAnswer AnswerTo(const WebRequest& request, const AllowedHosts& hosts, Site* site);

}  // namespace oraclegs
