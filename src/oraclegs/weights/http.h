#pragma once
// One GET over http or https, on top of libcurl. Proxies are libcurl's: http_proxy, https_proxy, all_proxy, no_proxy.

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>

namespace oraclegs {

struct HttpRequest {
  std::string url;
  std::string bearer = {};  ///< a secret for the server of `url` alone: it is not sent where that server redirects to
  uint64_t offset = 0;      ///< > 0: only the bytes from here on, which a server may ignore
};

struct HttpReply {
  int status = 0;
  /// Names in lower case. Those of redirections are among them (x-linked-etag comes with one); the last answer wins,
  /// but of x-linked-... the first.
  std::map<std::string, std::string> headers;

  /// A whole number >= 0; `otherwise` when the header is absent or none.
  uint64_t Number(const std::string& header, uint64_t otherwise) const;
};

struct HttpHandlers {
  std::function<void(const HttpReply&)> begin;  ///< once, before the first byte of a 200 or 206
  std::function<void(std::string_view)> body;   ///< each piece of the body of a 200 or 206
};

struct HttpEnd {
  HttpReply reply;
  std::string dropped;  ///< why the connection ended before the body did; empty = the body is whole
};

/// Follows up to ten redirections, never from https to http. Exceptions of handlers come out of here. Throws RunError
/// when no server answers or a redirection leads nowhere, Interrupted (core/interrupt.h). Messages show addresses
/// WithoutSecrets.
HttpEnd HttpGet(const HttpRequest& request, const HttpHandlers& handlers);

/// The address without user, password, query (which may hold a signature) and fragment.
std::string WithoutSecrets(const std::string& url);

/// Where an address leads, as libcurl reads it: not as its text looks.
struct Origin {
  std::string scheme, host;  ///< in lower case; empty when it is no address
  std::string text;          ///< "https://host:443"
  bool has_user = false;     ///< a user or a password stands in it
};
Origin OriginOf(const std::string& url);

}  // namespace oraclegs
