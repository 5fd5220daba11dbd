#include "oraclegs/web/routes.h"

#include <arpa/inet.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

namespace oraclegs {
namespace {

constexpr int kHttpPort = 80;  // browsers leave it out

std::string Lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

/// "[::1]" -> "::1"
std::string WithoutBrackets(const std::string& host) {
  const bool bracketed = host.size() > 2 && host.front() == '[' && host.back() == ']';
  return bracketed ? host.substr(1, host.size() - 2) : host;
}

bool IsIpAddress(const std::string& host) {
  std::array<unsigned char, sizeof(in6_addr)> bytes{};
  return inet_pton(AF_INET, host.c_str(), bytes.data()) == 1 || inet_pton(AF_INET6, host.c_str(), bytes.data()) == 1;
}

WebAnswer Route(const WebRequest& request, const AllowedHosts& hosts, Site* site) {
  if (request.method != "GET" && request.method != "HEAD") {
    WebAnswer answer = PlainAnswer(405, "only GET and HEAD");
    answer.headers["Allow"] = "GET, HEAD";
    return answer;
  }
  if (!hosts.Allows(request)) return PlainAnswer(403, "this server does not answer to that name");
  if (request.path == "/") return AssetAnswer("viewer.html", request.known_tag);
  return SiteAnswer(request.path, request.known_tag, site);
}

}  // namespace

bool IsWildcard(const std::string& host) {
  const std::string bare = WithoutBrackets(host);
  return bare.empty() || bare == "0.0.0.0" || bare == "::";
}

bool IsLoopback(const std::string& host) {
  const std::string bare = Lower(WithoutBrackets(host));
  return bare == "localhost" || bare == "::1" || (IsIpAddress(bare) && bare.rfind("127.", 0) == 0);
}

AllowedHosts::AllowedHosts(const std::string& host, int port)
    : host_(Lower(WithoutBrackets(host))), port_(std::to_string(port)), wildcard_(IsWildcard(host)) {
  std::array<char, 256> name{};
  if (gethostname(name.data(), name.size() - 1) == 0) machine_ = Lower(name.data());
}

bool AllowedHosts::Allows(const WebRequest& request) const { return request.hosts == 1 && Allows(request.host); }

bool AllowedHosts::Allows(const std::string& header) const {
  const size_t bracket = header.rfind(']');
  const size_t colon = header.find(':', bracket == std::string::npos ? 0 : bracket);
  const std::string port = colon == std::string::npos ? std::to_string(kHttpPort) : header.substr(colon + 1);
  if (port != port_) return false;
  const std::string name = Lower(WithoutBrackets(header.substr(0, colon)));
  if (name == "localhost" || name == "127.0.0.1" || name == "::1") return true;
  if (!wildcard_) return name == host_;
  return IsIpAddress(name) || (!machine_.empty() && name == machine_);
}

WebAnswer AnswerTo(const WebRequest& request, const AllowedHosts& hosts, Site* site) {
  return Restricted(Route(request, hosts, site), Frames::kNobody);
}

}  // namespace oraclegs
