#include "oraclegs/core/detached_program.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <system_error>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

/// A line of /proc/N/stat, as far as it is looked at.
struct ProcessLine {
  char state = 0;
  int64_t session = 0, started = 0;
};

std::optional<ProcessLine> ReadProcessLine(int64_t number) {
  std::string line;
  std::getline(std::ifstream(fs::path("/proc") / std::to_string(number) / "stat"), line);
  const size_t after_name = line.rfind(')');
  if (after_name == std::string::npos) return std::nullopt;
  std::istringstream fields(line.substr(after_name + 1));
  constexpr int kSession = 4, kStarted = 20;  // counted from the state, which is the first
  ProcessLine process;
  fields >> process.state;
  int64_t value = 0;
  for (int i = 2; i <= kStarted && fields >> value; ++i) {
    if (i == kSession) process.session = value;
    if (i == kStarted) process.started = value;
  }
  if (!fields) return std::nullopt;
  return process;
}

/// posix_spawn's two lists, freed at the end.
struct SpawnPlan {
  SpawnPlan() {
    posix_spawn_file_actions_init(&files);
    posix_spawnattr_init(&attributes);
  }
  ~SpawnPlan() {
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&attributes);
  }
  SpawnPlan(const SpawnPlan&) = delete;
  SpawnPlan& operator=(const SpawnPlan&) = delete;

  posix_spawn_file_actions_t files{};
  posix_spawnattr_t attributes{};
};

}  // namespace

nlohmann::json ProcessMarkToJson(const ProcessMark& mark) {
  return {{"number", mark.number}, {"started", mark.started}};
}

ProcessMark ProcessMarkFromJson(const nlohmann::json& json) {
  if (!json.is_object()) return {};
  const nlohmann::json number = json.value("number", nlohmann::json()),
                       started = json.value("started", nlohmann::json());
  if (!number.is_number_integer() || !started.is_number_integer() || number.get<int64_t>() <= 1) return {};
  return {number.get<int64_t>(), started.get<int64_t>()};
}

ProcessMark StartDetached(const std::vector<std::string>& argv, const fs::path& log) {
  const fs::path program = FindProgram(argv.at(0));
  if (program.empty()) throw RunError("{}: there is no such program", argv[0]);
  const int log_fd = open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  if (log_fd < 0) throw RunError("{}: cannot write: {}", log.string(), SystemReason(errno));
  SpawnPlan plan;
  posix_spawn_file_actions_addopen(&plan.files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&plan.files, log_fd, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&plan.files, log_fd, STDERR_FILENO);
  posix_spawn_file_actions_addclosefrom_np(&plan.files, STDERR_FILENO + 1);  // also sockets, which would stay in use
  sigset_t none, usual;
  sigemptyset(&none);
  sigemptyset(&usual);
  for (const int signal : {SIGINT, SIGTERM, SIGPIPE, SIGHUP}) sigaddset(&usual, signal);
  posix_spawnattr_setsigmask(&plan.attributes, &none);
  posix_spawnattr_setsigdefault(&plan.attributes, &usual);
  posix_spawnattr_setflags(&plan.attributes, POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  std::vector<std::string> words = argv;
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  pid_t pid = 0;
  const int error = posix_spawn(&pid, program.c_str(), &plan.files, &plan.attributes, pointers.data(), environ);
  close(log_fd);
  if (error != 0) throw RunError("cannot start {}: {}", program.string(), std::strerror(error));
  const auto line = ReadProcessLine(pid);  // there until this process has waited for it
  return {pid, line ? line->started : 0};
}

ProgramState StateOf(const ProcessMark& mark) {
  if (mark.number <= 1) return ProgramState::kGone;
  waitpid(static_cast<pid_t>(mark.number), nullptr, WNOHANG);  // lets go of a child of this process that has ended
  const auto line = ReadProcessLine(mark.number);
  if (!line || line->started != mark.started || line->state == 'Z' || line->state == 'X') return ProgramState::kGone;
  return line->state == 'T' || line->state == 't' ? ProgramState::kPaused : ProgramState::kRuns;
}

bool SignalSession(const ProcessMark& mark, int signal) {
  if (StateOf(mark) == ProgramState::kGone) return false;
  // A program must not see its children stop or end, or it may take that for their failure: it is last to go on, and
  // first for all else.
  const bool last = signal == SIGCONT;
  if (!last && !SignalProgram(mark, signal)) return false;
  // Its children are in groups of their own, but in its session.
  std::error_code error;
  for (fs::directory_iterator it("/proc", error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    const int64_t number = std::strtoll(name.c_str(), nullptr, 10);
    if (number == mark.number) continue;
    const auto line = ReadProcessLine(number);
    if (line && line->session == mark.number) kill(static_cast<pid_t>(number), signal);
  }
  return !last || SignalProgram(mark, signal);
}

bool SignalProgram(const ProcessMark& mark, int signal) {
  return StateOf(mark) != ProgramState::kGone && kill(static_cast<pid_t>(mark.number), signal) == 0;
}

}  // namespace oraclegs
