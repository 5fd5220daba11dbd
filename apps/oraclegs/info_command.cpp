#include <nlohmann/json.hpp>

#include "command.h"
#include "oraclegs/core/text.h"
#include "oraclegs/output/info.h"
#include "oraclegs/settings/options.h"

namespace oraclegs {
namespace {

struct InfoOptions {
  bool json = false, check = false;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("json", self.json, "Print JSON instead of lines");
    visit("check", self.check, "Also look at each photo: which are blurred, double, badly exposed or no photos at all");
  }
};

/// Text of a value: numbers of four digits, lists in parentheses, "key value, key value" for objects.
std::string ShownValue(const nlohmann::json& value) {
  if (value.is_string()) return OneLine(value.get<std::string>());
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_number_float()) return fmt::format("{:.4g}", value.get<double>());
  if (!value.is_structured()) return value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  std::vector<std::string> parts;
  for (const auto& [key, item] : value.items()) {
    parts.push_back((value.is_object() ? OneLine(key) + " " : "") + ShownValue(item));
  }
  if (parts.empty()) return "none";
  const std::string text = fmt::format("{}", fmt::join(parts, ", "));
  return value.is_array() ? "(" + text + ")" : text;
}

/// Options that differ from the defaults.
nlohmann::json ChangedOptions(const nlohmann::json& options) {
  const nlohmann::json usual = RunOptionsToJson(RunOptions{});
  nlohmann::json changed = nlohmann::json::object();
  for (const auto& [name, value] : options.items()) {
    if (!usual.contains(name) || usual[name] != value) changed[name] = value;
  }
  return changed;
}

std::string ShownItem(const std::string& key, const nlohmann::json& value) {
  if (key == "options") {
    const nlohmann::json changed = ChangedOptions(value);
    return changed.empty() ? "all at their defaults" : ShownValue(changed) + "; all others at their defaults";
  }
  if (key == "bounding_box") return ShownValue(value.at("min")) + " to " + ShownValue(value.at("max"));
  if (key == "camera_models" && value.empty()) return "not known: the photos have no poses yet";
  if (key == "sizes" && value.empty()) return "not known";
  return ShownValue(value);
}

/// True for a counter that may be left out where it is zero; such lines are not printed.
bool IsIdle(const std::string& key, const nlohmann::json& value) {
  const bool counts_trouble = key == "warnings" || key == "masks" || key == "sensor_depth" ||
                              key == "unreadable_images" || key == "missing_images";
  return counts_trouble && (value == 0 || (value.is_array() && value.empty()));
}

std::string Lines(const nlohmann::json& info) {
  std::string text = info.at("kind").get<std::string>();
  for (const auto& [key, value] : info.items()) {
    if (key == "kind" || key == "metrics" || IsIdle(key, value)) continue;
    std::string name = key;
    std::replace(name.begin(), name.end(), '_', ' ');
    text += fmt::format("\n  {:16} {}", name, ShownItem(key, value));
  }
  return text;
}

class InfoCommand : public Command {
 public:
  explicit InfoCommand(CLI::App* app)
      : Command(app, "info", "Show a summary of a scene, a workspace or a splat file", "oraclegs info scene/ --json") {
    BindInput("path", &path_, "Scene folder, workspace or splat file");
    Bind("Output", &options_);
    BindFileLimits(&limits_);
  }

 private:
  void Body(const Listener& listener) override {
    const nlohmann::json info = Describe(path_, options_.check, listener);
    // JSON of ASCII alone: nothing of it needs to be replaced in a terminal.
    std::string text = options_.json ? info.dump(2, ' ', true, nlohmann::json::error_handler_t::replace) : Lines(info);
    if (!options_.json && info.contains("metrics")) text += "\n" + SummaryOf(info["metrics"], path_);
    WriteOut(text + "\n");  // it was asked for: also with --quiet
  }

  std::filesystem::path path_;
  InfoOptions options_;
  FileLimits limits_;
};

}  // namespace

std::unique_ptr<Command> MakeInfo(CLI::App* app) { return std::make_unique<InfoCommand>(app); }

}  // namespace oraclegs
