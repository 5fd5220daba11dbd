#pragma once
// Base class of all subcommands: their declaration and start.

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "command_info.h"
#include "option_binder.h"
#include "oraclegs/core/option_table.h"
#include "oraclegs/settings/options.h"
#include "terminal.h"

namespace oraclegs {

struct OutputOptions {
  bool quiet = false;
  bool verbose = false;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("quiet", self.quiet, "Print only warnings and errors");
    visit("verbose", self.verbose, "Also print the options in force");
  }
};

struct WorkspaceOptions {
  std::filesystem::path out;
  bool overwrite = false;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("out", self.out, "Workspace: the folder for all results; a run that was stopped there is continued");
    visit("overwrite", self.overwrite, "Start anew: remove the results of an earlier run from the workspace");
  }
};

/// Visibility of a group of options: --help, or only --help-all.
enum class Level { kBasic, kAdvanced };

/// Choice of general options: --config, --quiet, --verbose and --help, or --help only.
enum class General { kAll, kHelpAlone };

/// A subcommand: options structs bound to groups of flags, and a body.
class Command {
 public:
  Command(CLI::App* app, const std::string& name, const std::string& help, const std::string& example,
          General general = General::kAll);
  virtual ~Command() = default;

  /// True when the command line named this command.
  bool Chosen() const { return app_->parsed(); }
  /// Reads --config, --preset and the like, checks all options, runs the body. `command_line` is what was typed.
  void Run(const std::string& command_line);
  /// Description of the command for the help.
  CommandInfo Info() const;
  CLI::App* app() const { return app_; }

 protected:
  template <class Options>
  void Bind(const char* group, Options* options, Level level = Level::kBasic) {
    Options::Visit(*options, OptionBinder(app_, &table_, group, [&](OptionInfo info, Tier tier) {
      info.basic = level == Level::kBasic;
      Remember(std::move(info), tier);
    }));
    checks_.push_back([options] { CheckOptions(*options); });
  }
  /// Binds the options of a run that RunScopeOf the command's name gives it, and --preset.
  void BindRun(RunOptions* options);
  /// Binds --threads, for commands that are no run.
  void BindMachine(MachineOptions* options);
  /// Binds --max-megapixels, for commands that are no run.
  void BindFileLimits(FileLimits* options);
  void BindInput(const char* name, std::filesystem::path* path, const char* help);
  /// Binds a positional argument of one path or more.
  void BindInputs(const char* name, std::vector<std::filesystem::path>* paths, const char* help);

  /// Sets the options of --preset that nothing before has set.
  virtual void TakePreset(const std::string& name);
  /// May set options, from the command's input, that no file and no flag has set.
  virtual void ApplyDefaults() {}
  /// True when this process computes, so that a device that this machine lacks is refused before any work.
  virtual bool ComputesHere() const { return true; }
  virtual void Body(const Listener& listener) = 0;

  /// All options by their names, also those that RunScope leaves to files.
  OptionTable& table() { return table_; }
  /// Command line as typed, quoted for a shell.
  const std::string& CommandLine() const { return command_line_; }
  /// Prints to stdout, unless --quiet was given.
  void Print(const std::string& text) const;

 private:
  void BindGeneral();
  void BindSet();
  /// Notes an option for the help. The first setting brings --set.
  void Remember(OptionInfo info, Tier tier);
  /// Sets what --set gives.
  void ApplySettings();

  CLI::App* app_;
  OptionTable table_;
  std::string example_;
  std::vector<OptionInfo> options_;   ///< all that app_ has
  std::vector<OptionInfo> settings_;  ///< all that --set alone has
  std::vector<std::string> set_;      ///< NAME=VALUE of each --set
  OutputOptions output_;
  const SplitOptions* split_ = nullptr;      ///< split of a command with the options of a run; null = has none
  const MachineOptions* machine_ = nullptr;  ///< machine options of the derived class
  const FileLimits* file_limits_ = nullptr;  ///< file limits of the derived class
  const DeviceOptions* device_ = nullptr;    ///< device options of the derived class; null = no choice
  std::filesystem::path config_;
  std::string preset_;
  std::string preset_warning_;  ///< of options that win over the preset; "" = none
  std::string command_line_;
  std::vector<std::function<void()>> checks_;
};

/// Throws UsageError when -o was not given.
void RequireOut(const std::filesystem::path& out);

/// Last lines of a run's output: scores, sizes, times, and the places of the files.
std::string SummaryOf(const nlohmann::json& metrics, const std::filesystem::path& workspace);

// One per file of this folder.
std::unique_ptr<Command> MakeReconstruct(CLI::App* app);
std::unique_ptr<Command> MakeAblate(CLI::App* app);
std::unique_ptr<Command> MakeBench(CLI::App* app);
std::unique_ptr<Command> MakeSfm(CLI::App* app);
std::unique_ptr<Command> MakeDepth(CLI::App* app);
std::unique_ptr<Command> MakePropose(CLI::App* app);
std::unique_ptr<Command> MakeValidate(CLI::App* app);
std::unique_ptr<Command> MakeTrain(CLI::App* app);
std::unique_ptr<Command> MakeEvaluate(CLI::App* app);
std::unique_ptr<Command> MakeRender(CLI::App* app);
std::unique_ptr<Command> MakeFigure(CLI::App* app);
std::unique_ptr<Command> MakeExport(CLI::App* app);
std::unique_ptr<Command> MakeConvert(CLI::App* app);
std::unique_ptr<Command> MakeView(CLI::App* app);
std::unique_ptr<Command> MakeMesh(CLI::App* app);
std::unique_ptr<Command> MakeCameras(CLI::App* app);
std::unique_ptr<Command> MakeInfo(CLI::App* app);
std::unique_ptr<Command> MakeApp(CLI::App* app);
std::unique_ptr<Command> MakeDoctor(CLI::App* app);
std::unique_ptr<Command> MakeModels(CLI::App* app);
std::unique_ptr<Command> MakeDemo(CLI::App* app);
std::unique_ptr<Command> MakeDemoScene(CLI::App* app);

// Those that speak of all commands ask for them when they run.
std::unique_ptr<Command> MakeHelp(CLI::App* app, std::function<Catalog()> catalog);
std::unique_ptr<Command> MakeCompletion(CLI::App* app, std::function<Catalog()> catalog);
std::unique_ptr<Command> MakeMan(CLI::App* app, std::function<Catalog()> catalog);

}  // namespace oraclegs
