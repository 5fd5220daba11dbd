#include "command.h"

#include <algorithm>
#include <iterator>
#include <set>

#include "config_file.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/text.h"
#include "oraclegs/image/image.h"
#include "oraclegs/settings/device.h"
#include "oraclegs/workspace/advice.h"
#include "oraclegs/workspace/workspace.h"
#include "presets.h"
#include "run_scope.h"

namespace oraclegs {
namespace {

constexpr size_t kMaxAdvice = 3;

std::string Number(const nlohmann::json& value, const char* unit) {
  return value.is_number() ? fmt::format("{:.3f}{}", value.get<double>(), unit) : "not known";
}

}  // namespace

Command::Command(CLI::App* app, const std::string& name, const std::string& help, const std::string& example,
                 General general)
    : app_(app->add_subcommand(name, help)), example_(example) {
  if (general == General::kAll) BindGeneral();
  app_->set_help_flag("-h,--help");
  app_->set_help_all_flag("--help-all");
  options_.push_back({.name = "help", .letter = 'h', .help = "Print this help", .group = "General"});
  options_.push_back({.name = "help-all", .help = "Print all options", .group = "General", .basic = false});
}

void Command::BindGeneral() {
  app_->add_option_function<std::string>("--config", [this](const std::string& text) { config_ = text; })
      ->type_name("FILE")
      ->configurable(false)
      ->take_last();
  options_.push_back({.name = "config",
                      .value = "FILE",
                      .help = "Options from a file: TOML lines of `option-name = value`, or the options.json of a run; "
                              "the command line wins over it",
                      .group = "General"});
  Bind("General", &output_);
  options_.back().basic = false;  // --verbose
}

void Command::BindRun(RunOptions* options) {
  const RunScope& scope = RunScopeOf(app_->get_name());
  RunOptions::ForEachGroup(*options, [&](const char* title, auto& group) {
    using Group = std::remove_reference_t<decltype(group)>;
    Group::Visit(group, [&, title](const char* name, auto& value, const auto&... rest) {
      const bool useful = scope.Has(title, name);
      if (!useful && scope.others == OtherOptions::kNone) return table_.Add(name, &value, rest...).LeaveToFiles();
      OptionBinder(app_, &table_, title, [&](OptionInfo info, Tier tier) {
        info.hidden = !useful;
        info.basic = scope.IsBasic(info.name);
        Remember(std::move(info), tier);
      })(name, value, rest...);
    });
    checks_.push_back([&group] { CheckOptions(group); });
  });
  split_ = &options->split;
  machine_ = &options->machine;
  device_ = &options->device;
  file_limits_ = &options->file_limits;
  app_->add_option("--preset", preset_)->type_name("NAME")->configurable(false)->take_last();
  options_.push_back(
      {.name = "preset",
       .value = "NAME",
       .help = fmt::format("Options of a named setting, over which --config and the command line win: {}",
                           fmt::join(PresetNames(), ", ")),
       .words = PresetNames(),
       .group = "General"});
}

void Command::Remember(OptionInfo info, Tier tier) {
  if (tier == Tier::kFlag) return options_.push_back(std::move(info));
  if (settings_.empty()) BindSet();
  settings_.push_back(std::move(info));
}

void Command::BindSet() {
  app_->add_option("--set", set_)->type_name("NAME=VALUE")->configurable(false)->allow_extra_args(false);
  options_.push_back({.name = "set",
                      .value = "NAME=VALUE",
                      .help =
                          "An expert's setting, of which `oraclegs help settings` explains all, or any option by its "
                          "name; may be given many times",
                      .group = "General",
                      .basic = false});
}

void Command::ApplySettings() {
  std::set<TableOption*> seen;
  for (const std::string& text : set_) {
    const size_t equals = text.find('=');
    const std::string name = text.substr(0, equals);
    TableOption* option = table_.Find(name);
    if (!option) {
      const std::string meant = DidYouMean(name, table_.Names());
      throw UsageError("--set {}: there is no such option{}", name,
                       meant.empty() ? "; `oraclegs help settings` lists them" : meant);
    }
    if (option->of_files_alone()) {
      throw UsageError("--set {}: {} has no use for it; leave it out", name, app_->get_name());
    }
    if (equals == std::string::npos) throw UsageError("--set {0} has no value; write --set {0}=VALUE", name);
    if (seen.insert(option).second && option->given()) {
      throw UsageError("--{0} and --set {0} are one option; leave one of them out", name);
    }
    option->Set(text.substr(equals + 1));
  }
}

void Command::BindMachine(MachineOptions* options) {
  Bind("Machine", options);
  machine_ = options;
}

void Command::BindFileLimits(FileLimits* options) {
  Bind("Machine", options, Level::kAdvanced);
  file_limits_ = options;
}

void Command::BindInput(const char* name, std::filesystem::path* path, const char* help) {
  app_->add_option_function<std::string>(
          name, [path](const std::string& text) { *path = text; }, help)
      ->type_name("PATH")
      ->configurable(false)
      ->required();
}

void Command::BindInputs(const char* name, std::vector<std::filesystem::path>* paths, const char* help) {
  app_->add_option_function<std::vector<std::string>>(
          name, [paths](const std::vector<std::string>& texts) { paths->assign(texts.begin(), texts.end()); }, help)
      ->type_name("PATH...")
      ->expected(1, 10000)
      ->configurable(false)
      ->required();
}

void Command::Run(const std::string& command_line) {
  command_line_ = command_line;
  ApplySettings();
  if (!config_.empty()) ApplyConfigFile(config_, app_->get_name(), &table_);
  if (!preset_.empty()) TakePreset(preset_);
  ApplyDefaults();
  for (const auto& check : checks_) check();
  if (device_ && ComputesHere()) ChooseDevice(device_->device, ProbeDevices());
  if (machine_) SetNumThreads(machine_->threads);
  if (file_limits_) SetMaxMegapixels(file_limits_->max_megapixels);
  Terminal terminal(output_.quiet ? Verbosity::kQuiet : output_.verbose ? Verbosity::kVerbose : Verbosity::kNormal);
  for (const CLI::Option* option : app_->get_options()) {
    if (option->count() > 0) Log().debug("option {} = {}", option->get_name(), fmt::join(option->results(), " "));
  }
  if (!preset_warning_.empty()) terminal.AsListener()(Warning{preset_warning_});
  Body(terminal.AsListener());
}

void Command::TakePreset(const std::string& name) {
  const std::map<std::string, std::string> overruled = ApplyPreset(name, app_->get_name(), &table_);
  const auto views = overruled.find("views");
  if (views == overruled.end() || !split_ || views->second == std::to_string(split_->views)) return;
  preset_warning_ = ForOtherViews(name, views->second, split_->views);
}

CommandInfo Command::Info() const {
  CommandInfo info{.name = app_->get_name(), .help = app_->get_description(), .group = "", .example = example_};
  for (const CLI::Option* argument : app_->get_options()) {
    if (!argument->get_positional()) continue;
    info.arguments.push_back({argument->get_name(), argument->get_type_name(), argument->get_description(),
                              argument->get_required(), argument->get_items_expected_max() > 1});
  }
  // Groups in the order of their first option; what is general comes last.
  std::vector<std::string> groups;
  for (const OptionInfo& option : options_) {
    if (option.group == "General") continue;
    if (std::find(groups.begin(), groups.end(), option.group) == groups.end()) groups.push_back(option.group);
  }
  groups.emplace_back("General");
  for (const std::string& group : groups) {
    std::copy_if(options_.begin(), options_.end(), std::back_inserter(info.options),
                 [&](const OptionInfo& option) { return option.group == group; });
  }
  info.settings = settings_;
  return info;
}

void Command::Print(const std::string& text) const {
  if (!output_.quiet) WriteOut(text + "\n");
}

void RequireOut(const std::filesystem::path& out) {
  if (out.empty()) throw UsageError("-o is missing: name the folder or file to write");
}

std::string SummaryOf(const nlohmann::json& metrics, const std::filesystem::path& workspace) {
  const nlohmann::json& test = metrics.at("test");
  std::string text = "test       no test pixels\n";
  if (metrics.contains("train_views")) {
    const nlohmann::json& seen = metrics["train_views"];
    text = fmt::format("photos     PSNR {}, SSIM {} at {} that it was trained on; --eval scores held-out views\n",
                       Number(seen.at("psnr"), " dB"), Number(seen.at("ssim"), ""),
                       Counted(seen.at("views").size(), "photo"));
  } else if (!test.at("views").empty()) {
    const std::string psnr = Number(test.at("psnr"), " dB"), ssim = Number(test.at("ssim"), ""),
                      corrected = Number(test.value("psnr_color_corrected", nlohmann::json()), " dB"),
                      views = Counted(test.at("views").size(), "view");
    const nlohmann::json plain = test.value("psnr_mean_exposure", nlohmann::json());
    const std::string in_mean =
        plain.is_null() ? ""
                        : fmt::format(", in the photos' mean exposure, which the splat has, {}", Number(plain, " dB"));
    text = fmt::format("test       PSNR {}, SSIM {}, mean of {} (PSNR after color correction {}{})\n", psnr, ssim,
                       views, corrected, in_mean);
  }
  text += fmt::format("model      {} Gaussians", metrics.at("gaussians").get<int64_t>());
  if (metrics.contains("train")) {
    const nlohmann::json& train = metrics["train"];
    text +=
        fmt::format(", {} iterations in {} ({:.1f}/s)", train.at("iterations").get<int64_t>(),
                    FormatSeconds(train.at("seconds").get<double>()), train.at("iterations_per_second").get<double>());
  }
  text += fmt::format(", peak memory {:.1f} GB\n", metrics.at("peak_memory_bytes").get<double>() / 1e9);
  const auto parts = metrics.value("non_commercial", std::vector<std::string>());
  if (!parts.empty()) {
    text += fmt::format("license    not for commercial use: made with {}\n", fmt::join(parts, ", "));
  }
  for (const auto& warning : metrics.value("warnings", std::vector<std::string>()))
    text += "warning    " + warning + "\n";
  if (workspace.empty()) return text;
  const WorkspacePaths paths(workspace);
  std::error_code ignored;
  const bool trained_here = std::filesystem::exists(paths.point_cloud(), ignored);
  if (trained_here) text += fmt::format("splat      {}\n", paths.point_cloud().string());
  text += fmt::format("metrics    {}\nimages     {}", paths.metrics().string(),
                      paths.renders(metrics.contains("train_views") ? "train" : "test").string());
  if (std::filesystem::exists(paths.report_page(), ignored)) {
    text += fmt::format("\nreport     {}", paths.report_page().string());
  }
  if (!trained_here) return text;
  for (const std::string& doubt : StoredPoseDoubts(workspace)) text += "\nwarning    " + doubt;
  for (const std::string& advice : PhotoAdvice(workspace, kMaxAdvice)) text += "\nnext photo " + advice;
  const std::string quoted = ShellQuoted(workspace.string());
  text += fmt::format(
      "\nlook       oraclegs view {}\nvideo      oraclegs render {}\nshare      oraclegs export {} -o scene.spz",
      quoted, quoted, quoted);
  return text;
}

}  // namespace oraclegs
