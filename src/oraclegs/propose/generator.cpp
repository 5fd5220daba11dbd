#include "oraclegs/propose/generator.h"

#include <chrono>
#include <system_error>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/core/subprocess.h"
#include "oraclegs/core/text.h"
#include "oraclegs/image/codecs.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kCountEvery{500};
constexpr size_t kShownOfLine = 60, kShownOfError = 300;

std::string QuotedForShell(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

/// Reports the number of answered images at intervals.
class AnswerProgress {
 public:
  AnswerProgress(const GeneratorPaths& paths, const std::vector<Target>& targets, const Listener& listener)
      : paths_(paths), targets_(targets), listener_(listener) {}

  void TakeLine(const std::string& line) {
    const size_t begin = line.rfind('\r') == std::string::npos ? 0 : line.rfind('\r') + 1;  // a bar redraws its line
    if (line.find_first_not_of(" \t", begin) != std::string::npos) {
      line_ = Printable(std::string_view(line).substr(begin), kShownOfLine);
    }
  }

  void Report() {
    if (Clock::now() < next_) return;
    next_ = Clock::now() + kCountEvery;
    Report(CountAnswers(paths_, targets_));
  }

  void Report(size_t done) {
    listener_(StepDone{"propose", static_cast<int64_t>(done), static_cast<int64_t>(targets_.size()), "generated views",
                       line_});
  }

 private:
  const GeneratorPaths& paths_;
  const std::vector<Target>& targets_;
  const Listener& listener_;
  Clock::time_point next_;
  std::string line_;
};

std::string WhatWentWrong(const ProcessResult& result) {
  if (result.last_error.empty()) return "it says nothing on stderr";
  return Printable(result.last_error, kShownOfError);
}

}  // namespace

std::string FilledCommand(const std::string& command, const GeneratorPaths& paths) {
  std::string filled;
  const std::pair<std::string_view, std::string> folders[] = {{"{request}", QuotedForShell(paths.request().string())},
                                                              {"{answer}", QuotedForShell(paths.answer().string())}};
  for (size_t at = 0; at < command.size();) {
    bool is_folder = false;
    for (const auto& [word, path] : folders) {
      if (command.compare(at, word.size(), word) != 0) continue;
      filled += path, at += word.size(), is_folder = true;
      break;
    }
    if (!is_folder) filled += command[at++];
  }
  return filled;
}

void RunGenerator(const GeneratorRun& run, const std::vector<Target>& targets, const Listener& listener) {
  const GeneratorPaths paths{fs::absolute(run.proposals / "generator")};
  AnswerProgress progress(paths, targets, listener);
  progress.Report(0);
  ProcessRequest request;
  request.argv = {"sh", "-c", FilledCommand(run.command, paths)};
  request.log = paths.log();
  request.on_line = [&](const std::string& line) { progress.TakeLine(line); };
  request.while_running = [&] { progress.Report(); };
  request.variables = {{"ORACLEGS_REQUEST", paths.request().string()}, {"ORACLEGS_ANSWER", paths.answer().string()}};
  request.errors_apart = true;
  if (run.timeout > 0) request.time_limit = std::chrono::seconds(run.timeout);
  const ProcessResult result = RunProcess(request);
  if (result.timed_out) {
    throw RunError(
        "--generator: the command was stopped after {} s, when {} of {} images were there; raise "
        "--generator-timeout (0 = no limit); what it printed is in {}",
        run.timeout, CountAnswers(paths, targets), targets.size(), paths.log().string());
  }
  if (result.exit_code != 0) {
    throw RunError("--generator: the command ended with exit code {}: {}; all that it printed is in {}",
                   result.exit_code, WhatWentWrong(result), paths.log().string());
  }
  const std::vector<Image8> images = ReadAnswers(paths, targets);
  progress.Report(targets.size());
  for (size_t t = 0; t < targets.size(); ++t) {
    WritePng(run.proposals / kGeneratorSource / (targets[t].name + ".png"), images[t]);
  }
  std::error_code ignored;
  fs::remove_all(paths.answer(), ignored);
}

void RemoveGeneratorFiles(const fs::path& proposals) {
  std::error_code ignored;
  fs::remove_all(proposals / "generator", ignored);
  fs::remove_all(proposals / kGeneratorSource, ignored);
}

}  // namespace oraclegs
