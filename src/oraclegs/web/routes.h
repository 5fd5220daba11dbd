#pragma once
// Answers of the viewer's server as a function of the request: refused requests and paths.

#include <string>

#include "oraclegs/web/answers.h"
#include "oraclegs/web/site.h"

namespace oraclegs {

/// Names by which the server may be addressed. A page of another site can make a browser send requests here under a
/// name that its owner resolves to this machine; such a name is not among them.
class AllowedHosts {
 public:
  /// Allows the names of `host`, to which the server is bound. For a wildcard: every IP address and this machine's
  /// name.
  AllowedHosts(const std::string& host, int port);
  /// Whether a request has one Host header, with such a name.
  bool Allows(const WebRequest& request) const;
  /// Whether the header Host is such a name.
  bool Allows(const std::string& header) const;
  const std::string& port() const { return port_; }

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
