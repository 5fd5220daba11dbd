// The command line: parses, calls the library, prints. Exit codes: 0, 2 usage, 3 bad input, 4 failed run,
// 130 interrupted.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <new>
#include <string>

#include "command.h"
#include "help_format.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/interrupt.h"

namespace oraclegs {
namespace {

constexpr int kUsage = 2, kFailed = 4;
constexpr const char* kMemoryAdvice =
    "out of memory; lower --max-gaussians or --random-points, or raise --downscale, and run the same command again";

int Fail(const std::string& text, int code) {
  const std::string line = text.substr(0, text.find('\n'));
  std::fprintf(stderr, "oraclegs: error: %s\n", line.c_str());
  return code;
}

/// "oraclegs train 'my scene' -o out", which a shell reads as what was typed.
std::string CommandLine(int argc, char** argv) {
  std::string line = "oraclegs";
  for (int i = 1; i < argc; ++i) line += " " + ShellQuoted(argv[i]);
  return line;
}

int RunChosen(const std::vector<std::unique_ptr<Command>>& commands, const std::string& command_line) {
  try {
    for (const auto& command : commands) {
      if (command->Chosen()) command->Run(command_line);
    }
    return 0;
  } catch (const Error& e) {
    return Fail(e.what(), e.exit_code());
  } catch (const std::bad_alloc&) {
    return Fail(kMemoryAdvice, kFailed);
  } catch (const std::filesystem::filesystem_error& e) {
    return Fail(fmt::format("{}: {}", e.path1().string(), e.code().message()), kFailed);
  } catch (const std::exception& e) {
    return Fail(fmt::format("internal error, please report it: {}", e.what()), kFailed);
  }
}

int Main(int argc, char** argv) {
  InstallInterruptHandlers();
  std::signal(SIGPIPE, SIG_IGN);  // `oraclegs info ... | head` is no crash
  std::signal(SIGXFSZ, SIG_IGN);  // a file that outgrows its limit is reported as a failed write

  CLI::App app{"OracleGS: a few photos become a 3D Gaussian splat."};
  app.formatter(std::make_shared<HelpFormat>());
  app.set_version_flag("--version", "oraclegs " ORACLEGS_VERSION);
  app.require_subcommand(1);
  app.footer(
      "`oraclegs COMMAND --help` explains a command. Start with:\n  oraclegs demo-scene /tmp/demo\n"
      "  oraclegs reconstruct /tmp/demo -o /tmp/demo_out --preset quick");
  std::vector<std::unique_ptr<Command>> commands;
  for (auto* make :
       {MakeReconstruct, MakeSfm, MakeDepth, MakePropose, MakeValidate, MakeTrain, MakeEvaluate, MakeAblate, MakeRender,
        MakeFigure, MakeExport, MakeMesh, MakeView, MakeInfo, MakeModels, MakeDemoScene}) {
    commands.push_back(make(&app));
  }
  try {
    app.parse(argc, argv);
  } catch (const Error& e) {  // a word that an option does not know
    return Fail(e.what(), e.exit_code());
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);  // --help, --version
    const auto chosen = app.get_subcommands();
    const std::string help = chosen.empty() ? "" : chosen.front()->get_name() + " ";
    std::string what = e.what();
    if (chosen.empty() && argc > 1 && argv[1][0] != '-') what = fmt::format("there is no command '{}'", argv[1]);
    std::replace(what.begin(), what.end(), '\n', ' ');
    return Fail(fmt::format("{}; see `oraclegs {}--help`", what, help), kUsage);
  }
  return RunChosen(commands, CommandLine(argc, argv));
}

}  // namespace
}  // namespace oraclegs

int main(int argc, char** argv) { return oraclegs::Main(argc, argv); }
