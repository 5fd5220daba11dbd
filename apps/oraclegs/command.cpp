#include "command.h"

#include <cstdio>

#include "config_file.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/text.h"
#include "oraclegs/pipeline/settings/device.h"
#include "oraclegs/pipeline/workspace/workspace.h"

namespace oraclegs {
namespace {

std::string Number(const nlohmann::json& value, const char* unit) {
  return value.is_number() ? fmt::format("{:.3f}{}", value.get<double>(), unit) : "not known";
}

}  // namespace

Command::Command(CLI::App* app, const std::string& name, const std::string& help, const std::string& example)
    : app_(app->add_subcommand(name, help)) {
  app_->footer("Example:\n  " + example);
  app_->add_option_function<std::string>(
          "--config", [this](const std::string& text) { config_ = text; },
          "TOML file of `option-name = value` lines; the command line wins over it")
      ->type_name("FILE")
      ->configurable(false)
      ->group("General");
  Bind("General", &output_);
  app_->set_help_flag("-h,--help", "Print this help")->group("General");
}

void Command::BindRun(RunOptions* options) {
  RunOptions::ForEachGroup(*options, [&](const char* title, auto& group) { Bind(title, &group); });
  machine_ = &options->machine;
  device_ = &options->device;
  app_->add_option("--preset", preset_,
                   "Options of a published or usual setting, a file of presets/; --config wins over it")
      ->type_name("NAME")
      ->configurable(false)
      ->group("General");
}

void Command::BindMachine(MachineOptions* options) {
  Bind("Machine", options);
  machine_ = options;
}

void Command::BindInput(const char* name, std::filesystem::path* path, const char* help) {
  app_->add_option_function<std::string>(
          name, [path](const std::string& text) { *path = text; }, help)
      ->type_name("PATH")
      ->configurable(false)
      ->required();
}

void Command::Run(const std::string& command_line) {
  command_line_ = command_line;
  if (!config_.empty()) ApplyConfigFile(config_, app_);
  if (!preset_.empty()) ApplyPreset(preset_, app_);
  ApplyDefaults();
  for (const auto& check : checks_) check();
  if (device_) ChooseDevice(device_->device, ProbeDevices());  // what cannot be had is refused before any work
  if (machine_) SetNumThreads(machine_->threads);
  Terminal terminal(output_.quiet ? Verbosity::kQuiet : output_.verbose ? Verbosity::kVerbose : Verbosity::kNormal);
  for (const CLI::Option* option : app_->get_options()) {
    if (option->count() > 0) Log().debug("option {} = {}", option->get_name(), fmt::join(option->results(), " "));
  }
  Body(terminal.AsListener());
}

void Command::Print(const std::string& text) const {
  if (output_.quiet) return;
  std::fputs((text + "\n").c_str(), stdout);
  std::fflush(stdout);
}

void RequireOut(const std::filesystem::path& out) {
  if (out.empty()) throw UsageError("-o is missing: name the folder or file to write");
}

std::string SummaryOf(const nlohmann::json& metrics, const std::filesystem::path& workspace) {
  const nlohmann::json& test = metrics.at("test");
  std::string text = "test       no test pixels\n";
  if (!test.at("views").empty()) {
    text = fmt::format("test       PSNR {}, SSIM {}, mean of {} views (PSNR after colour correction {})\n",
                       Number(test.at("psnr"), " dB"), Number(test.at("ssim"), ""), test.at("views").size(),
                       Number(test.value("psnr_color_corrected", nlohmann::json()), " dB"));
  }
  text += fmt::format("model      {} Gaussians", metrics.at("gaussians").get<int64_t>());
  if (metrics.contains("train")) {
    const nlohmann::json& train = metrics["train"];
    text +=
        fmt::format(", {} iterations in {} ({:.1f}/s)", train.at("iterations").get<int64_t>(),
                    FormatSeconds(train.at("seconds").get<double>()), train.at("iterations_per_second").get<double>());
  }
  text += fmt::format(", {:.1f} GB memory at most\n", metrics.at("peak_memory_bytes").get<double>() / 1e9);
  const auto parts = metrics.value("non_commercial", std::vector<std::string>());
  if (!parts.empty()) {
    text += fmt::format("licence    not for commercial use: made with {}\n", fmt::join(parts, ", "));
  }
  if (workspace.empty()) return text;
  const WorkspacePaths paths(workspace);
  std::error_code ignored;
  const bool trained_here = std::filesystem::exists(paths.point_cloud(), ignored);
  if (trained_here) text += fmt::format("splat      {}\n", paths.point_cloud().string());
  text += fmt::format("metrics    {}\nimages     {}", paths.metrics().string(), paths.renders("test").string());
  if (std::filesystem::exists(paths.report_page(), ignored)) {
    text += fmt::format("\nreport     {}", paths.report_page().string());
  }
  if (trained_here) text += fmt::format("\nto look    oraclegs view {}", ShellQuoted(workspace.string()));
  return text;
}

}  // namespace oraclegs
