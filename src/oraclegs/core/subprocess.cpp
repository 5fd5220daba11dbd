#include "oraclegs/core/subprocess.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string_view>
#include <thread>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/core/interrupt.h"

namespace oraclegs {
namespace fs = std::filesystem;
namespace {

constexpr size_t kKeptBytes = 64 * 1024;
constexpr int kPollMilliseconds = 50;                     // how soon an interrupt is noticed
constexpr std::chrono::milliseconds kPatience{3000};      // between SIGTERM and SIGKILL
constexpr int kCannotStart = 127, kKilledBySignal = 128;  // the shell's convention

/// A running child, in a process group of its own so that its children end with it. Ends it when the scope is left.
class Child {
 public:
  /// start_error() tells why when nothing runs.
  explicit Child(const std::vector<std::string>& argv) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) throw RunError("cannot start {}: {}", argv[0], std::strerror(errno));
    output_ = ends[0];
    start_error_ = Spawn(argv, ends[1]);
    close(ends[1]);
  }
  ~Child() {
    End();
    close(output_);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  int start_error() const { return start_error_; }
  int output() const { return output_; }
  int exit_code() const { return WIFEXITED(status_) ? WEXITSTATUS(status_) : kKilledBySignal + WTERMSIG(status_); }

  bool HasEnded() {
    if (pid_ <= 0) return true;
    if (waitpid(pid_, &status_, WNOHANG) != pid_) return false;
    pid_ = 0;
    return true;
  }

  void Wait() {
    if (pid_ <= 0) return;
    while (waitpid(pid_, &status_, 0) < 0 && errno == EINTR) continue;
    pid_ = 0;
  }

  void End() {
    if (HasEnded()) return;
    kill(-pid_, SIGTERM);
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (std::chrono::steady_clock::now() < deadline) {
      if (HasEnded()) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    kill(-pid_, SIGKILL);
    Wait();
  }

 private:
  int Spawn(const std::vector<std::string>& argv, int write_end) {
    std::vector<char*> arguments;
    // posix_spawn takes char* but writes nothing.
    for (const auto& argument : argv) arguments.push_back(const_cast<char*>(argument.c_str()));
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&files, write_end, STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&files, write_end, STDERR_FILENO);
    sigset_t defaults;  // a signal we ignore must not be ignored by the child
    sigemptyset(&defaults);
    for (const int signal : {SIGINT, SIGTERM, SIGPIPE}) sigaddset(&defaults, signal);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setsigdefault(&attributes, &defaults);
    const int error = posix_spawnp(&pid_, arguments[0], &files, &attributes, arguments.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
    if (error != 0) pid_ = 0;
    return error;
  }

  pid_t pid_ = 0;
  int output_ = -1;
  int status_ = 0;
  int start_error_ = 0;
};

/// Where a child's output goes: log file, kept tail, lines.
class OutputSink {
 public:
  OutputSink(const fs::path& log, const std::function<void(const std::string&)>& on_line)
      : log_path_(log), on_line_(on_line) {
    if (log.empty()) return;
    log_.open(log, std::ios::app | std::ios::binary);
    if (!log_) throw RunError("{}: cannot write: {}", log.string(), std::strerror(errno));
  }

  void Take(std::string_view bytes) {
    if (log_.is_open()) {
      log_.write(bytes.data(), static_cast<std::streamsize>(bytes.size())).flush();
      if (!log_) throw RunError("{}: cannot write: {}", log_path_.string(), std::strerror(errno));
    }
    tail_.append(bytes);
    if (tail_.size() > 2 * kKeptBytes) tail_.erase(0, tail_.size() - kKeptBytes);
    for (const char c : bytes) {
      if (c == '\n' || line_.size() >= kKeptBytes) HandLine();
      if (c != '\n') line_.push_back(c);
    }
  }

  std::string Finish() {
    if (!line_.empty()) HandLine();
    if (tail_.size() > kKeptBytes) tail_.erase(0, tail_.size() - kKeptBytes);
    return std::move(tail_);
  }

 private:
  void HandLine() {
    if (!line_.empty() && line_.back() == '\r') line_.pop_back();
    const std::string line = std::exchange(line_, {});
    if (on_line_) on_line_(line);
  }

  fs::path log_path_;
  std::ofstream log_;
  const std::function<void(const std::string&)>& on_line_;
  std::string tail_, line_;
};

/// Hands over what is there; false at the end of the output.
bool ReadSome(int fd, OutputSink& sink) {
  char buffer[16384];
  const ssize_t n = read(fd, buffer, sizeof(buffer));
  if (n < 0) return errno == EINTR || errno == EAGAIN;
  sink.Take(std::string_view(buffer, static_cast<size_t>(n)));
  return n > 0;
}

bool IsProgram(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored) && access(path.c_str(), X_OK) == 0;
}

}  // namespace

ProcessResult RunProcess(const std::vector<std::string>& argv, const fs::path& log,
                         const std::function<void(const std::string& line)>& on_line) {
  if (argv.empty()) throw std::logic_error("RunProcess: no program named");
  ThrowIfInterrupted();
  OutputSink sink(log, on_line);
  Child child(argv);
  if (child.start_error() != 0) {
    sink.Take(fmt::format("cannot start {}: {}\n", argv[0], std::strerror(child.start_error())));
    return {kCannotStart, sink.Finish()};
  }
  // A grandchild that lives on may hold the pipe open: once the child has ended, only what is there is read.
  bool ended = false;
  while (true) {
    ThrowIfInterrupted();
    pollfd wait{child.output(), POLLIN, 0};
    const int ready = poll(&wait, 1, ended ? 0 : kPollMilliseconds);
    if (ready > 0 && !ReadSome(child.output(), sink)) break;
    if (ready == 0 && ended) break;
    if (ready <= 0) ended = child.HasEnded();
  }
  while (!child.HasEnded()) {  // it may close its output long before it ends
    ThrowIfInterrupted();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return {child.exit_code(), sink.Finish()};
}

fs::path FindProgram(const std::string& name) {
  if (name.empty()) return {};
  if (name.find('/') != std::string::npos) return IsProgram(name) ? fs::absolute(name) : fs::path();
  const char* path = std::getenv("PATH");
  std::string_view folders = path ? path : "/usr/local/bin:/usr/bin:/bin";
  while (true) {
    const size_t colon = std::min(folders.find(':'), folders.size());
    const fs::path candidate = fs::path(colon == 0 ? "." : std::string(folders.substr(0, colon))) / name;
    if (IsProgram(candidate)) return fs::absolute(candidate);
    if (colon == folders.size()) return {};
    folders.remove_prefix(colon + 1);
  }
}

}  // namespace oraclegs
