#include "oraclegs/web/routes.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <functional>
#include <utility>

#include "oraclegs/web/assets.h"

namespace oraclegs {
namespace {

constexpr uint64_t kMaxFileBytes = uint64_t{4} << 30;
constexpr int kHttpPort = 80;  // browsers leave it out
constexpr const char* kText = "text/plain; charset=utf-8";
constexpr const char* kJson = "application/json";

// Only scripts of the page, also as WebAssembly and in workers; no request leaves this server; no other site may frame
// it or read from it.
constexpr const char* kContentPolicy =
    "default-src 'self'; script-src 'self' 'wasm-unsafe-eval' blob:; worker-src 'self' blob:; "
    "img-src 'self' data: blob:; style-src 'self'; connect-src 'self' data: blob:; "
    "media-src 'self' blob:; object-src 'none'; form-action 'none'; frame-ancestors 'none'; base-uri 'none'";

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

const char* TypeOf(const std::string& path) {
  static constexpr std::pair<const char*, const char*> kTypes[] = {
      {".jpg", "image/jpeg"}, {".jpeg", "image/jpeg"}, {".png", "image/png"},  {".webp", "image/webp"},
      {".json", kJson},       {".mp4", "video/mp4"},   {".webm", "video/webm"}};
  const std::string extension = Lower(std::filesystem::path(path).extension().string());
  for (const auto& [end, type] : kTypes) {
    if (extension == end) return type;
  }
  return "application/octet-stream";  // never a page or a script
}

WebAnswer Plain(int status, const std::string& text) {
  WebAnswer answer;
  answer.status = status;
  answer.type = kText;
  answer.body = text + "\n";
  return answer;
}

/// The answer with its tag, or "not modified" if the browser knows the tag.
WebAnswer Tagged(WebAnswer answer, const std::string& tag, const std::string& known) {
  const std::string quoted = '"' + tag + '"';
  answer.headers["ETag"] = quoted;
  if (known != quoted) return answer;
  answer.status = 304;
  answer.body.clear();
  answer.type.clear();
  answer.file.reset();
  return answer;
}

WebAnswer AssetAnswer(const std::string& name, const std::string& known) {
  // report.html is a template, not a page of this server.
  const auto asset = name.rfind("report.", 0) == 0 ? std::nullopt : FindWebAsset(name);
  if (!asset) return Plain(404, "not found");
  WebAnswer answer;
  answer.type = std::string(asset->type);
  answer.body = std::string(asset->bytes);
  const std::string tag = fmt::format("{:x}", std::hash<std::string_view>{}(asset->bytes));
  return Tagged(std::move(answer), tag, known);
}

WebAnswer DocumentAnswer(std::optional<SiteDocument> document, const std::string& known) {
  WebAnswer answer;
  if (!document) {
    answer.status = 204;
    return answer;
  }
  answer.type = kJson;
  answer.body = std::move(document->json);
  return Tagged(std::move(answer), document->tag, known);
}

WebAnswer FileAnswer(const std::string& path, const std::string& known, Site* site) {
  auto file = site->File(path);
  if (!file) return Plain(404, "not found");
  if (file->size() > kMaxFileBytes) return Plain(413, "the file is too large");
  const std::string tag = file->tag();
  WebAnswer answer;
  answer.type = TypeOf(path);
  answer.file = std::move(file);
  return Tagged(std::move(answer), tag, known);
}

/// The rest of `path` after `prefix`; nullopt for other paths.
std::optional<std::string> After(const std::string& path, std::string_view prefix) {
  if (path.rfind(prefix, 0) != 0) return std::nullopt;
  return path.substr(prefix.size());
}

WebAnswer Route(const WebRequest& request, const AllowedHosts& hosts, Site* site) {
  if (request.method != "GET" && request.method != "HEAD") {
    WebAnswer answer = Plain(405, "only GET and HEAD");
    answer.headers["Allow"] = "GET, HEAD";
    return answer;
  }
  if (request.hosts != 1 || !hosts.Allows(request.host)) return Plain(403, "this server does not answer to that name");
  if (request.path == "/") return AssetAnswer("viewer.html", request.known_tag);
  if (request.path == "/api/ping") return Plain(200, "oraclegs");
  if (request.path == "/api/document") return DocumentAnswer(site->Document(), request.known_tag);
  if (request.path == "/api/live") return DocumentAnswer(site->Live(), request.known_tag);
  if (const auto name = After(request.path, "/assets/")) return AssetAnswer(*name, request.known_tag);
  if (const auto path = After(request.path, "/files/")) return FileAnswer(*path, request.known_tag, site);
  return Plain(404, "not found");
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
  WebAnswer answer = Route(request, hosts, site);
  answer.headers["Content-Security-Policy"] = kContentPolicy;
  answer.headers["X-Content-Type-Options"] = "nosniff";
  answer.headers["X-Frame-Options"] = "DENY";
  answer.headers["Referrer-Policy"] = "no-referrer";
  answer.headers["Cross-Origin-Resource-Policy"] = "same-origin";
  answer.headers["Cross-Origin-Opener-Policy"] = "same-origin";
  answer.headers["Cache-Control"] = "no-cache";  // asked again each time, by the ETag
  return answer;
}

}  // namespace oraclegs
