// A request to the viewer's server, and the two documents that it serves: run.json, state.json, then lines with method,
// path, host and tag.

#include <nlohmann/json.hpp>

#include "fuzz/fuzz.h"
#include "oraclegs/web/routes.h"

namespace {

std::string_view NextLine(std::string_view* text) {
  const std::string_view line = text->substr(0, text->find('\n'));
  text->remove_prefix(std::min(text->size(), line.size() + 1));
  return line;
}

}  // namespace

ORACLEGS_FUZZ_TARGET(web_request) {
  using namespace oraclegs;
  static const fuzz::Folder folder;
  static const auto image = folder.Put("out/a.jpg", "image"), secret = folder.Put("secret", "secret");
  static const AllowedHosts hosts[] = {{"127.0.0.1", 80}, {"::", 7860}};
  const auto parts = fuzz::Parts(bytes);
  folder.Put("out/report/run.json", parts[0]);
  folder.Put("out/live/state.json", fuzz::PartAt(parts, 1));
  Site site(folder.path() / "out");
  std::string_view lines = fuzz::PartAt(parts, 2);
  WebRequest request;
  request.method = NextLine(&lines);
  request.path = NextLine(&lines);
  request.host = NextLine(&lines);
  request.known_tag = NextLine(&lines);
  for (const AllowedHosts& names : hosts) {
    const WebAnswer answer = AnswerTo(request, names, &site);
    if (answer.file && answer.file->ReadAll(1 << 20).value_or("").find("secret") != std::string::npos) {
      fuzz::Fail("a file outside of the folder");
    }
    for (const auto& [name, value] : answer.headers) fuzz::CheckMessage(name + value);
  }
  site.Document();
  site.Live();
}
