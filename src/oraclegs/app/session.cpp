#include "oraclegs/app/session.h"

#include <random>

#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

/// Cookies of one name are shared by all ports of a host.
std::string CookieName(const AllowedHosts& hosts) { return "oraclegs-" + hosts.port(); }

/// Compares in a time that does not depend on where the texts differ.
bool IsSame(const std::string& a, const std::string& b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (size_t i = 0; i < a.size(); ++i)
    difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  return difference == 0;
}

}  // namespace

Session::Session() {
  std::random_device random;  // of the kernel
  for (int i = 0; i < 4; ++i) secret_ += fmt::format("{:08x}", random());
}

bool Session::Holds(const WebRequest& request, const AllowedHosts& hosts) const {
  const std::string wanted = CookieName(hosts) + "=" + secret_;
  for (const std::string& cookie : SplitTrimmed(request.cookie, ';')) {
    if (IsSame(cookie, wanted)) return true;
  }
  return false;
}

WebAnswer Session::Open(const WebRequest& request, const AllowedHosts& hosts) const {
  if (!IsSame(request.path, path())) {
    return PlainAnswer(403, "This address is of an earlier start. Use the one that OracleGS printed last.");
  }
  WebAnswer answer;
  answer.headers["Set-Cookie"] = fmt::format("{}={}; Path=/; HttpOnly; SameSite=Strict", CookieName(hosts), secret_);
  answer.type = "text/html; charset=utf-8";
  // A page that goes on by itself, in place of a redirection, which browsers count to the site that led here: the
  // cookie would not be sent.
  answer.body = "<!doctype html><title>OracleGS</title><meta http-equiv=\"refresh\" content=\"0; url=/\">\n";
  return answer;
}

bool Session::IsOwnPage(const WebRequest& request) { return request.origin == "http://" + request.host; }

}  // namespace oraclegs
