#include <cstdio>

#include "command.h"
#include "oraclegs/core/text.h"
#include "oraclegs/weights/check.h"
#include "oraclegs/weights/fetch.h"
#include "oraclegs/weights/folder.h"

namespace oraclegs {
namespace {

struct CheckFileOptions {
  std::filesystem::path file;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("file", self.file, "File to check in place of the one that `fetch` brings");
  }
};

std::string Size(uint64_t bytes) {
  return bytes < 1'000'000'000 ? fmt::format("{:.0f} MB", static_cast<double>(bytes) / 1e6)
                               : fmt::format("{:.2f} GB", static_cast<double>(bytes) / 1e9);
}

std::string ListText() {
  std::vector<std::vector<std::string>> rows = {{"name", "size", "here", "for"}};
  for (const WeightsInfo& model : AllWeights()) {
    const auto here = LocateWeights(model.name);
    rows.push_back({model.name, Size(model.download_bytes), here ? "yes" : "no", model.purpose});
    std::string licence = "licence " + model.licence;
    if (model.non_commercial) licence += "; not for commercial use";
    if (!model.restriction.empty()) licence += "; " + model.restriction;
    if (model.gated) licence += "; needs an account that agreed to it (HF_TOKEN)";
    rows.push_back({"", "", "", licence});
    for (const PublishedFile& file : model.files) rows.push_back({"", "", "", file.url});
    if (here) rows.push_back({"", "", "", here->string()});
  }
  return AlignColumns(rows, "lrll");
}

class ModelsCommand : public Command {
 public:
  explicit ModelsCommand(CLI::App* app)
      : Command(app, "models", "List, fetch and check the weights of networks",
                "oraclegs models list\n  oraclegs models fetch depth-anything-v2-small --accept-licence\n"
                "  oraclegs models check depth-anything-v2-small") {
    this->app()
        ->add_option("action", action_, "list, fetch or check")
        ->type_name("ACTION")
        ->configurable(false)
        ->required();
    this->app()
        ->add_option("name", name_, "Model to fetch or check, as `list` names it")
        ->type_name("NAME")
        ->configurable(false);
    Bind("Fetch", &fetch_);
    Bind("Check", &check_);
  }

 private:
  void Body(const Listener& listener) override {
    if (action_ == "list") {
      if (!name_.empty()) throw UsageError("`oraclegs models list` takes no name");
      std::fputs(ListText().c_str(), stdout);  // it was asked for: also with --quiet
    } else if (action_ == "fetch") {
      const auto settings =
          FetchSettingsFromEnvironment(std::filesystem::path(ORACLEGS_SCRIPT_DIR) / "convert_weights.py");
      Print(FetchWeights(Model(), fetch_, settings, listener).string());
    } else if (action_ == "check") {
      const auto file = check_.file.empty() ? RequireWeights(Model().name) : check_.file;
      const size_t tensors = CheckWeights(Model(), file);
      Print(fmt::format("{}: all {} tensors of {} are there", file.string(), tensors, name_));
    } else {
      throw UsageError("there is no `oraclegs models {}`, only list, fetch NAME and check NAME", action_);
    }
  }

  const WeightsInfo& Model() const {
    if (name_.empty())
      throw UsageError("`oraclegs models {}` needs a name; `oraclegs models list` shows them", action_);
    return WeightsNamed(name_);
  }

  std::string action_, name_;
  FetchOptions fetch_;
  CheckFileOptions check_;
};

}  // namespace

std::unique_ptr<Command> MakeModels(CLI::App* app) { return std::make_unique<ModelsCommand>(app); }

}  // namespace oraclegs
