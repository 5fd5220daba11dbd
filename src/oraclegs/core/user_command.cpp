#include "oraclegs/core/user_command.h"

#include <chrono>
#include <string_view>
#include <system_error>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/subprocess.h"
#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

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
  AnswerProgress(const AwaitedAnswers& awaited, const Listener& listener) : awaited_(awaited), listener_(listener) {}

  void TakeLine(const std::string& line) {
    const size_t begin = line.rfind('\r') == std::string::npos ? 0 : line.rfind('\r') + 1;  // a bar redraws its line
    if (line.find_first_not_of(" \t", begin) != std::string::npos) {
      line_ = Printable(std::string_view(line).substr(begin), kShownOfLine);
    }
  }

  void ReportNow() {
    next_ = Clock::now() + kCountEvery;
    listener_(StepDone{awaited_.stage, static_cast<int64_t>(awaited_.count()), static_cast<int64_t>(awaited_.total),
                       awaited_.what, line_});
  }

  void ReportWhenDue() {
    if (Clock::now() >= next_) ReportNow();
  }

 private:
  const AwaitedAnswers& awaited_;
  const Listener& listener_;
  Clock::time_point next_;
  std::string line_;
};

std::string WhatWentWrong(const ProcessResult& result) {
  if (result.last_error.empty()) return "it says nothing on stderr";
  return Printable(result.last_error, kShownOfError);
}

}  // namespace

void RequireUtf8Command(const std::string& option, const std::string& text) {
  if (!IsUtf8(text)) throw UsageError("{} is not valid UTF-8: {}", option, EscapeBytes(text));
}

void EmptyCommandFolders(const CommandFolders& folders) {
  std::error_code error;
  std::filesystem::remove_all(folders.root, error);
  if (error) throw RunError("{}: cannot be removed: {}", folders.root.string(), SystemReason(error));
  RequireWritableFolder(folders.answer());
}

std::string FilledCommand(const std::string& command, const CommandFolders& folders) {
  std::string filled;
  const std::pair<std::string_view, std::string> words[] = {{"{request}", QuotedForShell(folders.request().string())},
                                                            {"{answer}", QuotedForShell(folders.answer().string())}};
  for (size_t at = 0; at < command.size();) {
    bool is_folder = false;
    for (const auto& [word, path] : words) {
      if (command.compare(at, word.size(), word) != 0) continue;
      filled += path, at += word.size(), is_folder = true;
      break;
    }
    if (!is_folder) filled += command[at++];
  }
  return filled;
}

void RunUserCommand(const UserCommand& command, const AwaitedAnswers& awaited, const Listener& listener) {
  const CommandFolders folders{std::filesystem::absolute(command.folders.root)};
  AnswerProgress progress(awaited, listener);
  progress.ReportNow();
  ProcessRequest request;
  request.argv = {"sh", "-c", FilledCommand(command.text, folders)};
  request.log = folders.log();
  request.on_line = [&](const std::string& line) { progress.TakeLine(line); };
  request.while_running = [&] { progress.ReportWhenDue(); };
  request.variables = {{"ORACLEGS_REQUEST", folders.request().string()},
                       {"ORACLEGS_ANSWER", folders.answer().string()}};
  request.errors_apart = true;
  if (command.timeout > 0) request.time_limit = std::chrono::seconds(command.timeout);
  const ProcessResult result = RunProcess(request);
  if (result.timed_out) {
    throw RunError(
        "{}: the command was stopped after {} s, when {} of {} images were there; raise --generator-timeout (0 = no "
        "limit); what it printed is in {}",
        command.option, command.timeout, awaited.count(), awaited.total, folders.log().string());
  }
  if (result.exit_code != 0) {
    throw RunError("{}: the command ended with exit code {}: {}; all that it printed is in {}", command.option,
                   result.exit_code, WhatWentWrong(result), folders.log().string());
  }
  progress.ReportNow();
}

}  // namespace oraclegs
