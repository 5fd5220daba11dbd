#include "program.h"

#include "help_text.h"
#include "mistakes.h"
#include "oraclegs/core/text.h"
#include "terminal.h"
#include "version.h"

namespace oraclegs {
namespace {

constexpr int kUsage = 2, kGoOn = -1;

/// "oraclegs train 'my scene' -o out", which a shell reads as what was typed.
std::string CommandLineOf(int argc, char** argv) {
  std::string line = "oraclegs";
  for (int i = 1; i < argc; ++i) line += " " + ShellQuoted(argv[i]);
  return line;
}

/// Words of the command line, last first, as CLI11 takes them. A path "[2024]", which it would read as a list, gets
/// "./".
std::vector<std::string> ForParser(int argc, char** argv) {
  std::vector<std::string> words;
  for (int i = argc - 1; i > 0; --i) {
    const std::string word = argv[i];
    words.push_back(word.starts_with('[') && word.ends_with(']') ? "./" + word : word);
  }
  return words;
}

}  // namespace

int Fail(const std::string& text, int code) {
  WriteError(text);
  return code;
}

Program::Program() {
  app_.name("oraclegs");
  app_.set_help_flag("-h,--help");
  app_.set_help_all_flag("--help-all");
  app_.set_version_flag("--version", [] { return VersionText(); });
  app_.require_subcommand(1);
  const auto add = [&](const char* title, auto... make) {
    groups_.push_back({title, {}});
    (groups_.back().commands.push_back(make(&app_)), ...);
  };
  const auto catalog = [this] { return Describe(); };
  const auto of_all = [&](auto* make) { return [=](CLI::App* app) { return make(app, catalog); }; };
  add("Photos to splat", MakeApp, MakeReconstruct, MakeDemo, MakeDemoScene);
  add("Look and share", MakeView, MakeRender, MakeExport, MakeConvert, MakeMesh, MakeCameras, MakeInfo);
  add("Single stages", MakeSfm, MakeDepth, MakePropose, MakeValidate, MakeTrain);
  add("Measure", MakeEvaluate, MakeBench, MakeAblate, MakeFigure);
  add("Set up", MakeDoctor, MakeModels, of_all(MakeHelp), of_all(MakeCompletion), of_all(MakeMan));
}

Catalog Program::Describe() const {
  Catalog catalog;
  for (const Group& group : groups_) {
    for (const auto& command : group.commands) {
      catalog.push_back(command->Info());
      catalog.back().group = group.title;
    }
  }
  return catalog;
}

Command* Program::Chosen() const {
  for (const Group& group : groups_) {
    for (const auto& command : group.commands) {
      if (command->Chosen()) return command.get();
    }
  }
  return nullptr;
}

int Program::Parse(int argc, char** argv) {
  if (const auto mistake = FindMistake({argv + 1, argv + argc}, app_, Describe())) return Fail(*mistake, kUsage);
  const auto help = [&](bool all) {
    const Command* chosen = Chosen();
    WriteOut(chosen ? HelpText(chosen->Info(), all) : OverviewText(Describe()));
    return 0;
  };
  try {
    app_.parse(ForParser(argc, argv));
    return kGoOn;
  } catch (const CLI::CallForHelp&) {
    return help(false);
  } catch (const CLI::CallForAllHelp&) {
    return help(true);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) return Fail(Explain(error, app_), kUsage);
    WriteOut(std::string(error.what()) + "\n");  // --version
    return 0;
  }
}

int Program::Run(int argc, char** argv) {
  const int code = Parse(argc, argv);
  if (code != kGoOn) return code;
  Chosen()->Run(CommandLineOf(argc, argv));
  return 0;
}

}  // namespace oraclegs
