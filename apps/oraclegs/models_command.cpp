#include "command.h"
#include "oraclegs/core/text.h"
#include "oraclegs/weights/check.h"
#include "oraclegs/weights/convert.h"
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

struct ConvertOptions {
  std::filesystem::path out;
  std::string model, key;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("out", self.out, "Safetensors file to write; with --model by default the place where it is looked for");
    visit("model", self.model, "Network that the files are for, as `list` names it; without it all tensors are kept");
    visit("key", self.key, "Where in the files the state dict is, if it is found nowhere usual");
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
    std::string license = "license " + model.license;
    if (model.non_commercial) license += "; not for commercial use";
    if (!model.restriction.empty()) license += "; " + model.restriction;
    if (model.gated) license += "; needs an account that agreed to it (HF_TOKEN)";
    rows.push_back({"", "", "", license});
    for (const PublishedFile& file : model.files) rows.push_back({"", "", "", file.url});
    if (here) rows.push_back({"", "", "", here->string()});
  }
  return AlignColumns(rows, "lrll");
}

/// Where the weights go: to a place of the user's, or where the program looks for them, if nothing is there.
std::filesystem::path Target(const ConvertOptions& options, const std::vector<std::string>& files) {
  if (options.out.empty() && options.model.empty()) {
    throw UsageError("`oraclegs models convert` needs --out FILE.safetensors or --model NAME");
  }
  if (options.out.empty()) {
    const auto here = LocateWeights(options.model);
    if (here) throw UsageError("{}: is here already and is not replaced; remove it, or give --out", here->string());
    return FetchedFile(options.model);
  }
  for (const std::string& file : files) {
    std::error_code unknown;
    if (std::filesystem::equivalent(options.out, file, unknown)) {
      throw UsageError("--out {} is one of the files to convert; give another name", options.out.string());
    }
  }
  return options.out;
}

class ModelsCommand : public Command {
 public:
  explicit ModelsCommand(CLI::App* app)
      : Command(app, "models", "List, fetch, check and convert the weights of networks",
                "oraclegs models list\n  oraclegs models fetch depth-anything-v2-small --accept-license\n"
                "  oraclegs models check depth-anything-v2-small\n"
                "  oraclegs models convert --model lpips-vgg vgg16-397923af.pth vgg.pth") {
    this->app()
        ->add_option("action", action_, "list, fetch, check or convert")
        ->type_name("ACTION")
        ->configurable(false)
        ->required();
    this->app()
        ->add_option("name", names_, "Model to fetch or check, as `list` names it; files to convert")
        ->type_name("NAME or FILE")
        ->configurable(false);
    Bind("Fetch", &fetch_);
    Bind("Check", &check_);
    Bind("Convert", &convert_);
  }

 private:
  void Body(const Listener& listener) override {
    if (action_ == "list") {
      if (!names_.empty()) throw UsageError("`oraclegs models list` takes no name");
      WriteOut(ListText());  // it was asked for: also with --quiet
    } else if (action_ == "fetch") {
      Print(FetchWeights(Model(), fetch_, FetchSettingsFromEnvironment(), listener).string());
    } else if (action_ == "check") {
      const auto file = check_.file.empty() ? RequireWeights(Model().name) : check_.file;
      const size_t tensors = CheckWeights(Model(), file, listener);
      const bool is_published = CheckPublished(Model(), file, listener);
      Print(fmt::format("{}: all {} tensors of {} are there{}", file.string(), tensors, Model().name,
                        is_published ? ", and it is the published file (SHA-256)" : ""));
    } else if (action_ == "convert") {
      ConvertFiles(listener);
    } else {
      throw UsageError("there is no `oraclegs models {}`, only list, fetch NAME, check NAME and convert FILE...",
                       action_);
    }
  }

  void ConvertFiles(const Listener& listener) {
    if (names_.empty()) throw UsageError("`oraclegs models convert` needs the files to convert");
    ConvertRequest request{{names_.begin(), names_.end()}, {}, convert_.key};
    if (!convert_.model.empty()) request.model = &WeightsNamed(convert_.model);
    request.to = Target(convert_, names_);
    const size_t tensors = ConvertWeights(request, listener);
    Print(fmt::format("{}: {} tensors", request.to.string(), tensors));
  }

  const WeightsInfo& Model() const {
    if (names_.size() != 1) {
      throw UsageError("`oraclegs models {}` needs {} name; `oraclegs models list` shows them", action_,
                       names_.empty() ? "a" : "one");
    }
    return WeightsNamed(names_.front());
  }

  std::string action_;
  std::vector<std::string> names_;
  FetchOptions fetch_;
  CheckFileOptions check_;
  ConvertOptions convert_;
};

}  // namespace

std::unique_ptr<Command> MakeModels(CLI::App* app) { return std::make_unique<ModelsCommand>(app); }

}  // namespace oraclegs
