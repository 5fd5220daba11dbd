#include "oraclegs/core/subprocess.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
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

/// True when a process of the group runs; those that ended and wait for their parent do not.
bool HasRunning(pid_t group) {
  if (kill(-group, 0) != 0) return false;
  std::error_code error;
  for (fs::directory_iterator it("/proc", error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    std::string stat;
    std::getline(std::ifstream(it->path() / "stat"), stat);
    const size_t after_name = stat.rfind(')');
    if (after_name == std::string::npos) continue;
    char state = 0;
    int64_t parent = 0, member_of = 0;
    std::istringstream(stat.substr(after_name + 1)) >> state >> parent >> member_of;
    if (member_of == group && state != 'Z' && state != 'X') return true;
  }
  return false;
}

/// A pipe from a child.
struct Pipe {
  explicit Pipe(const std::string& program) {
    if (pipe2(ends, O_CLOEXEC) != 0) throw RunError("cannot start {}: {}", program, std::strerror(errno));
  }
  ~Pipe() {
    CloseWriteEnd();
    close(ends[0]);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  void CloseWriteEnd() {
    if (ends[1] >= 0) close(std::exchange(ends[1], -1));
  }

  int ends[2] = {-1, -1};
};

/// The way into a child: a socket, because writing to one that nobody reads any more need not raise SIGPIPE.
class InputSocket {
 public:
  explicit InputSocket(const ProcessRequest& request) : next_(request.next_input) {
    if (!next_) return;
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends_) != 0) {
      throw RunError("cannot start {}: {}", request.argv[0], std::strerror(errno));
    }
  }
  ~InputSocket() {
    Close(&ends_[0]);
    Close(&ends_[1]);
  }
  InputSocket(const InputSocket&) = delete;
  InputSocket& operator=(const InputSocket&) = delete;

  int childs_end() const { return ends_[0]; }
  int ours() const { return ends_[1]; }
  void CloseChildsEnd() { Close(&ends_[0]); }

  /// Hands on what the child takes without waiting.
  void Write() {
    if (at_ == bytes_.size()) {
      bytes_ = next_();
      at_ = 0;
      if (bytes_.empty()) return Close(&ends_[1]);
    }
    const ssize_t n = send(ends_[1], bytes_.data() + at_, bytes_.size() - at_, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (n >= 0) at_ += static_cast<size_t>(n);
    if (n < 0 && errno != EAGAIN && errno != EINTR) Close(&ends_[1]);
  }

 private:
  static void Close(int* fd) {
    if (*fd >= 0) close(std::exchange(*fd, -1));
  }

  const std::function<std::string()>& next_;
  int ends_[2] = {-1, -1};
  std::string bytes_;
  size_t at_ = 0;
};

/// A running child, in a process group of its own so that its children end with it. Ends it when the scope is left.
class Child {
 public:
  /// start_error() tells why when nothing runs.
  explicit Child(const ProcessRequest& request) : output_(request.argv[0]), errors_(request.argv[0]), input_(request) {
    start_error_ = Spawn(request);
    input_.CloseChildsEnd();
    output_.CloseWriteEnd();
    errors_.CloseWriteEnd();
  }
  ~Child() { End(); }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  int start_error() const { return start_error_; }
  int output() const { return output_.ends[0]; }
  int errors() const { return errors_.ends[0]; }
  InputSocket* input() { return &input_; }
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
    const pid_t group = pid_;
    kill(-group, SIGTERM);
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (std::chrono::steady_clock::now() < deadline) {
      if (HasEnded() && !HasRunning(group)) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    kill(-group, SIGKILL);
    Wait();
  }

 private:
  int Spawn(const ProcessRequest& request) {
    std::vector<std::string> texts = request.argv;
    for (char** variable = environ; *variable != nullptr; ++variable) {
      const std::string_view text = *variable;
      const bool replaced = std::any_of(request.variables.begin(), request.variables.end(), [&](const auto& own) {
        return text.size() > own.first.size() && text.starts_with(own.first) && text[own.first.size()] == '=';
      });
      if (!replaced) texts.emplace_back(text);
    }
    for (const auto& [name, value] : request.variables) texts.push_back(name + "=" + value);
    std::vector<char*> arguments, variables;
    for (size_t i = 0; i < texts.size(); ++i)
      (i < request.argv.size() ? arguments : variables).push_back(texts[i].data());
    arguments.push_back(nullptr), variables.push_back(nullptr);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    if (request.next_input) {
      posix_spawn_file_actions_adddup2(&files, input_.childs_end(), STDIN_FILENO);
    } else {
      posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    }
    posix_spawn_file_actions_adddup2(&files, output_.ends[1], STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&files, (request.errors_apart ? errors_ : output_).ends[1], STDERR_FILENO);
    sigset_t defaults;  // a signal we ignore must not be ignored by the child
    sigemptyset(&defaults);
    for (const int signal : {SIGINT, SIGTERM, SIGPIPE}) sigaddset(&defaults, signal);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setsigdefault(&attributes, &defaults);
    const int error = posix_spawnp(&pid_, arguments[0], &files, &attributes, arguments.data(), variables.data());
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
    if (error != 0) pid_ = 0;
    return error;
  }

  Pipe output_, errors_;
  InputSocket input_;
  pid_t pid_ = 0;
  int status_ = 0;
  int start_error_ = 0;
};

/// Where a child's output goes: log file, kept tail, lines.
class OutputSink {
 public:
  explicit OutputSink(const ProcessRequest& request) : request_(request) {
    if (request.log.empty()) return;
    log_.open(request.log, std::ios::app | std::ios::binary);
    if (!log_) throw RunError("{}: cannot write: {}", request.log.string(), std::strerror(errno));
  }

  void TakeOutput(std::string_view bytes) { Take(bytes, &line_); }
  void TakeErrors(std::string_view bytes) { Take(bytes, &error_line_); }

  ProcessResult Finish(int exit_code) {
    for (std::string* line : {&line_, &error_line_}) {
      if (!line->empty()) HandLine(line);
    }
    if (tail_.size() > kKeptBytes) tail_.erase(0, tail_.size() - kKeptBytes);
    return {exit_code, std::move(tail_), std::move(last_error_)};
  }

 private:
  void Take(std::string_view bytes, std::string* line) {
    if (log_.is_open()) {
      log_.write(bytes.data(), static_cast<std::streamsize>(bytes.size())).flush();
      if (!log_) throw RunError("{}: cannot write: {}", request_.log.string(), std::strerror(errno));
    }
    tail_.append(bytes);
    if (tail_.size() > 2 * kKeptBytes) tail_.erase(0, tail_.size() - kKeptBytes);
    for (const char c : bytes) {
      if (c == '\n' || line->size() >= kKeptBytes) HandLine(line);
      if (c != '\n') line->push_back(c);
    }
  }

  void HandLine(std::string* buffer) {
    if (!buffer->empty() && buffer->back() == '\r') buffer->pop_back();
    const std::string line = std::exchange(*buffer, {});
    if (buffer == &error_line_ && line.find_first_not_of(" \t\r") != std::string::npos) last_error_ = line;
    if (request_.on_line) request_.on_line(line);
  }

  const ProcessRequest& request_;
  std::ofstream log_;
  std::string tail_, line_, error_line_, last_error_;
};

/// Hands over what is there; false at the end of the output.
template <class Sink>
bool ReadSome(int fd, const Sink& take) {
  char buffer[16384];
  const ssize_t n = read(fd, buffer, sizeof(buffer));
  if (n < 0) return errno == EINTR || errno == EAGAIN;
  take(std::string_view(buffer, static_cast<size_t>(n)));
  return n > 0;
}

/// What the two pipes of a child bring, and what its stdin takes.
class ChildStreams {
 public:
  ChildStreams(Child* child, OutputSink* sink)
      : sink_(sink),
        input_(child->input()),
        pipes_{{child->output(), POLLIN, 0}, {child->errors(), POLLIN, 0}, {input_->ours(), POLLOUT, 0}} {}

  bool open() const { return pipes_[0].fd >= 0 || pipes_[1].fd >= 0 || pipes_[2].fd >= 0; }

  void StopInput() { pipes_[2].fd = -1; }

  /// False when nothing came or went in that time.
  bool Serve(int milliseconds) {
    if (poll(pipes_, 3, milliseconds) <= 0) return false;
    const auto read = [](pollfd* pipe, const auto& take) {
      if (pipe->fd >= 0 && pipe->revents != 0 && !ReadSome(pipe->fd, take)) pipe->fd = -1;  // which poll passes over
    };
    read(&pipes_[0], [&](std::string_view bytes) { sink_->TakeOutput(bytes); });
    read(&pipes_[1], [&](std::string_view bytes) { sink_->TakeErrors(bytes); });
    if (pipes_[2].fd >= 0 && pipes_[2].revents != 0) {
      input_->Write();
      pipes_[2].fd = input_->ours();
    }
    return true;
  }

 private:
  OutputSink* sink_;
  InputSocket* input_;
  pollfd pipes_[3];
};

bool IsProgram(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored) && access(path.c_str(), X_OK) == 0;
}

}  // namespace

ProcessResult RunProcess(const ProcessRequest& request) {
  if (request.argv.empty()) throw std::logic_error("RunProcess: no program named");
  ThrowIfInterrupted();
  OutputSink sink(request);
  Child child(request);
  if (child.start_error() != 0) {
    sink.TakeErrors(fmt::format("cannot start {}: {}\n", request.argv[0], std::strerror(child.start_error())));
    return sink.Finish(kCannotStart);
  }
  const auto start = std::chrono::steady_clock::now();
  ChildStreams streams(&child, &sink);
  // A grandchild that lives on may hold a pipe open: once the child has ended, only what is there is read.
  bool ended = false;
  while (!ended || (streams.open() && streams.Serve(0))) {
    ThrowIfInterrupted();
    if (request.time_limit && std::chrono::steady_clock::now() - start > *request.time_limit) {
      child.End();
      ProcessResult result = sink.Finish(child.exit_code());
      result.timed_out = true;
      return result;
    }
    if (request.while_running) request.while_running();
    if (ended) continue;
    if (!streams.open()) {  // it may close them long before it ends
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    } else if (streams.Serve(kPollMilliseconds)) {
      continue;
    }
    ended = child.HasEnded();
    if (ended) streams.StopInput();
  }
  return sink.Finish(child.exit_code());
}

ProcessResult RunProcess(const std::vector<std::string>& argv, const fs::path& log,
                         const std::function<void(const std::string& line)>& on_line) {
  return RunProcess({.argv = argv, .log = log, .on_line = on_line});
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
