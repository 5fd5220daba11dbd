#include "oraclegs/web/answers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <functional>
#include <utility>

#include "oraclegs/web/assets.h"
#include "oraclegs/web/site.h"

namespace oraclegs {
namespace {

constexpr uint64_t kMaxFileBytes = uint64_t{4} << 30;
constexpr const char* kText = "text/plain; charset=utf-8";
constexpr const char* kJson = "application/json";

// Only scripts of the page, also as WebAssembly and in workers; no request leaves this server; no other site may read
// from it.
constexpr const char* kContentPolicy =
    "default-src 'self'; script-src 'self' 'wasm-unsafe-eval' blob:; worker-src 'self' blob:; "
    "img-src 'self' data: blob:; style-src 'self'; connect-src 'self' data: blob:; "
    "media-src 'self' blob:; object-src 'none'; form-action 'none'; base-uri 'none'";

const char* TypeOf(const std::string& path) {
  static constexpr std::pair<const char*, const char*> kTypes[] = {
      {".jpg", "image/jpeg"}, {".jpeg", "image/jpeg"}, {".png", "image/png"},  {".webp", "image/webp"},
      {".json", kJson},       {".mp4", "video/mp4"},   {".webm", "video/webm"}};
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const auto& [end, type] : kTypes) {
    if (extension == end) return type;
  }
  return "application/octet-stream";  // never a page or a script
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

}  // namespace

WebAnswer PlainAnswer(int status, const std::string& text) {
  WebAnswer answer;
  answer.status = status;
  answer.type = kText;
  answer.body = text + "\n";
  return answer;
}

WebAnswer JsonAnswer(std::string json, const std::string& known_tag) {
  const std::string tag = fmt::format("{:x}", std::hash<std::string>{}(json));
  WebAnswer answer;
  answer.type = kJson;
  answer.body = std::move(json);
  return Tagged(std::move(answer), tag, known_tag);
}

WebAnswer AssetAnswer(const std::string& name, const std::string& known_tag) {
  const auto asset = name.rfind("report.", 0) == 0 ? std::nullopt : FindWebAsset(name);
  if (!asset) return PlainAnswer(404, "not found");
  WebAnswer answer;
  answer.type = std::string(asset->type);
  answer.body = std::string(asset->bytes);
  const std::string tag = fmt::format("{:x}", std::hash<std::string_view>{}(asset->bytes));
  return Tagged(std::move(answer), tag, known_tag);
}

WebAnswer FileAnswer(std::optional<FileBelow> file, const std::string& name, const std::string& known_tag) {
  if (!file) return PlainAnswer(404, "not found");
  if (file->size() > kMaxFileBytes) return PlainAnswer(413, "the file is too large");
  const std::string tag = file->tag();
  WebAnswer answer;
  answer.type = TypeOf(name);
  answer.file = std::move(file);
  return Tagged(std::move(answer), tag, known_tag);
}

WebAnswer SiteAnswer(const std::string& path, const std::string& known_tag, Site* site) {
  if (path == "/api/ping") return PlainAnswer(200, "oraclegs");
  if (path == "/api/document") return DocumentAnswer(site->Document(), known_tag);
  if (path == "/api/live") return DocumentAnswer(site->Live(), known_tag);
  if (const auto name = PathAfter(path, "/assets/")) return AssetAnswer(*name, known_tag);
  if (const auto file = PathAfter(path, "/files/")) return FileAnswer(site->File(*file), *file, known_tag);
  return PlainAnswer(404, "not found");
}

WebAnswer Restricted(WebAnswer answer, Frames frames) {
  const bool own = frames == Frames::kThisServer;
  answer.headers.emplace("Content-Security-Policy",
                         fmt::format("{}; frame-ancestors {}", kContentPolicy, own ? "'self'" : "'none'"));
  answer.headers["X-Frame-Options"] = own ? "SAMEORIGIN" : "DENY";
  answer.headers["X-Content-Type-Options"] = "nosniff";
  answer.headers["Referrer-Policy"] = "no-referrer";
  answer.headers["Cross-Origin-Resource-Policy"] = "same-origin";
  answer.headers["Cross-Origin-Opener-Policy"] = "same-origin";
  answer.headers["Cache-Control"] = "no-cache";  // asked again each time, by the ETag
  return answer;
}

std::optional<std::string> PathAfter(const std::string& path, std::string_view prefix) {
  if (path.rfind(prefix, 0) != 0) return std::nullopt;
  return path.substr(prefix.size());
}

}  // namespace oraclegs
