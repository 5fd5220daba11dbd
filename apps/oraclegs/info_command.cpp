#include <cstdio>
#include <nlohmann/json.hpp>

#include "command.h"
#include "oraclegs/pipeline/info.h"

namespace oraclegs {
namespace {

struct InfoOptions {
  bool json = false;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("json", self.json, "Print JSON instead of lines");
  }
};

std::string ShownValue(const nlohmann::json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (!value.is_structured()) return value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  std::string text;
  for (const auto& [key, item] : value.items()) {
    text += fmt::format("{}{}", text.empty() ? "" : ", ",
                        value.is_object() ? fmt::format("{} {}", key, ShownValue(item)) : ShownValue(item));
  }
  return text.empty() ? "none" : text;
}

std::string Lines(const nlohmann::json& info) {
  std::string text = info.at("kind").get<std::string>();
  for (const auto& [key, value] : info.items()) {
    if (key == "kind" || key == "metrics") continue;
    std::string name = key;
    std::replace(name.begin(), name.end(), '_', ' ');
    text += fmt::format("\n  {:16} {}", name, ShownValue(value));
  }
  return text;
}

class InfoCommand : public Command {
 public:
  explicit InfoCommand(CLI::App* app)
      : Command(app, "info", "Say what a scene folder, a workspace or a .ply holds", "oraclegs info scene/ --json") {
    BindInput("path", &path_, "Scene folder, workspace or .ply file");
    Bind("Output", &options_);
  }

 private:
  void Body(const Listener& listener) override {
    const nlohmann::json info = Describe(path_, listener);
    std::string text = options_.json ? info.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) : Lines(info);
    if (!options_.json && info.contains("metrics")) text += "\n" + SummaryOf(info["metrics"], path_);
    std::fputs((text + "\n").c_str(), stdout);  // it was asked for: also with --quiet
  }

  std::filesystem::path path_;
  InfoOptions options_;
};

}  // namespace

std::unique_ptr<Command> MakeInfo(CLI::App* app) { return std::make_unique<InfoCommand>(app); }

}  // namespace oraclegs
