#include "oraclegs/web/assets.h"

#include "oraclegs/web/embedded.h"

namespace oraclegs {
namespace {

std::string_view MimeTypeOf(std::string_view name) {
  if (name.ends_with(".html")) return "text/html; charset=utf-8";
  if (name.ends_with(".js")) return "text/javascript; charset=utf-8";
  if (name.ends_with(".css")) return "text/css; charset=utf-8";
  return "application/octet-stream";
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

}  // namespace oraclegs
