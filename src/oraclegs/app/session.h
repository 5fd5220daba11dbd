#pragma once
// Who may use the app: the browser that was given the secret of this start.

#include <string>

#include "oraclegs/web/routes.h"

namespace oraclegs {

/// A secret of 128 bits, new at each start. The browser gets it as an address, which becomes a cookie that scripts
/// cannot read and that no other site's requests carry.
class Session {
 public:
  Session();

  /// Path that lets a browser in: "/open/SECRET".
  std::string path() const { return kPrefix + secret_; }

  /// Whether a request carries the cookie.
  bool Holds(const WebRequest& request, const AllowedHosts& hosts) const;
  /// The answer to a path that begins with "/open/": the cookie and the way on, or 403.
  WebAnswer Open(const WebRequest& request, const AllowedHosts& hosts) const;
  /// Whether a change may be made: the browser says that a page of this server asked for it.
  static bool IsOwnPage(const WebRequest& request);

  static constexpr const char* kPrefix = "/open/";

 private:
  std::string secret_;
};

}  // namespace oraclegs
