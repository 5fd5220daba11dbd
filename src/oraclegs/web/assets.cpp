#include "oraclegs/web/assets.h"

#include <nlohmann/json.hpp>

#include "oraclegs/core/error.h"
#include "oraclegs/web/embedded.h"

namespace oraclegs {
namespace {

std::string_view MimeTypeOf(std::string_view name) {
  if (name.ends_with(".html")) return "text/html; charset=utf-8";
  if (name.ends_with(".js")) return "text/javascript; charset=utf-8";
  if (name.ends_with(".css")) return "text/css; charset=utf-8";
  return "application/octet-stream";
}

std::string_view RequiredAsset(std::string_view name) {
  const std::optional<WebAsset> asset = FindWebAsset(name);
  if (!asset) throw RunError("the report page is not part of this program; {}", HowToBuildWebPages());
  return asset->bytes;
}

/// JSON for a <script> element. Invalid UTF-8 becomes U+FFFD: a file name must not stop a report.
std::string EscapedJson(const nlohmann::json& document) {
  const std::string text = document.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  std::string escaped;
  escaped.reserve(text.size() + 64);
  for (size_t at = 0; at < text.size();) {
    const size_t found = std::min(text.find('<', at), text.size());
    escaped.append(text, at, found - at);
    if (found < text.size()) escaped += "\\u003c";
    at = found + 1;
  }
  return escaped;
}

}  // namespace

std::optional<WebAsset> FindWebAsset(std::string_view name) {
  for (const EmbeddedFile& file : EmbeddedWebFiles()) {
    if (file.name == name) return WebAsset{{file.begin, file.end}, MimeTypeOf(name)};
  }
  return std::nullopt;
}

bool WebPagesBuilt() { return !EmbeddedWebFiles().empty(); }

std::string_view HowToBuildWebPages() {
  return "run scripts/bootstrap.sh, which installs the packages of web/ with npm, then build again";
}

std::string SelfContainedPage(const nlohmann::json& document) {
  const std::string_view page = RequiredAsset("report.html");
  const std::string json = EscapedJson(document);
  const std::string_view style = RequiredAsset("report.css"), script = RequiredAsset("report.js");
  const std::pair<std::string_view, std::string_view> parts[] = {
      {"/*STYLE*/", style}, {"{\"DOCUMENT\":0}", json}, {"/*SCRIPT*/", script}};  // in the order of the template
  std::string out;
  out.reserve(page.size() + style.size() + json.size() + script.size());
  size_t at = 0;
  for (const auto& [marker, text] : parts) {
    const size_t found = page.find(marker, at);
    if (found == std::string_view::npos) throw RunError("the template report.html lacks {}", marker);
    out.append(page, at, found - at).append(text);
    at = found + marker.size();
  }
  return out.append(page, at);
}

}  // namespace oraclegs
