#include "oraclegs/core/subprocess.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
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
#include "oraclegs/core/process_group.h"

namespace oraclegs {
namespace fs = std::filesystem;
namespace {

constexpr size_t kKeptBytes = 64 * 1024;
constexpr int kPollMilliseconds = 50;  // how soon an interrupt is noticed

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

/// A running program with what leads to and from it. Ends it when the scope is left.
class Child {
 public:
  explicit Child(const ProcessRequest& request)
      : output_(request.argv[0]),
        errors_(request.argv[0]),
        input_(request),
        group_({request.argv, request.variables, request.next_input ? input_.childs_end() : -1, output_.ends[1],
                (request.errors_apart ? errors_ : output_).ends[1]}) {
    input_.CloseChildsEnd();
    output_.CloseWriteEnd();
    errors_.CloseWriteEnd();
  }

  ProcessGroup* group() { return &group_; }
  int output() const { return output_.ends[0]; }
  int errors() const { return errors_.ends[0]; }
  InputSocket* input() { return &input_; }

 private:
  Pipe output_, errors_;
  InputSocket input_;
  ProcessGroup group_;
};

/// Whether a program still does something: it prints, takes input or computes.
class StallWatch {
 public:
  explicit StallWatch(std::chrono::duration<double> limit) : limit_(limit) {}

  void NoteSign() { since_ = Clock::now(), cpu_since_ = -1; }

  bool HasStalled(const ProcessGroup& group) {
    const auto now = Clock::now();
    const bool slept = now - last_call_ > limit_ / 2;  // this process was paused, or the machine: so was the program
    last_call_ = now;
    if (slept) NoteSign();
    if (now < next_look_) return false;
    next_look_ = now + std::chrono::duration_cast<Clock::duration>(limit_ / kLooks);
    const double cpu = group.CpuSeconds();
    if (cpu_since_ < 0) cpu_since_ = cpu;
    if (cpu - cpu_since_ > kBusyShare * limit_.count()) NoteSign();
    return now - since_ > limit_;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr int kLooks = 20;           // in the time of the limit
  static constexpr double kBusyShare = 0.02;  // of one core; what waits in a loop uses less
  std::chrono::duration<double> limit_;
  Clock::time_point since_ = Clock::now(), next_look_ = since_, last_call_ = since_;
  double cpu_since_ = -1;  ///< -1 = not looked at since the last sign
};

/// Where a child's output goes: log file, kept tail, lines.
class OutputSink {
 public:
  explicit OutputSink(const ProcessRequest& request) : request_(request) {
    if (request.log.empty()) return;
    log_.open(request.log, std::ios::app | std::ios::binary);
    if (!log_) throw RunError("{}: cannot write: {}", request.log.string(), SystemReason(errno));
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
      if (!log_) throw RunError("{}: cannot write: {}", request_.log.string(), SystemReason(errno));
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

/// Reads the two pipes of a child to their ends while it feeds the child's stdin.
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

}  // namespace

ProcessResult RunProcess(const ProcessRequest& request) {
  if (request.argv.empty()) throw std::logic_error("RunProcess: no program named");
  ThrowIfInterrupted();
  OutputSink sink(request);
  Child child(request);
  if (const int error = child.group()->start_error(); error != 0) {
    sink.TakeErrors(fmt::format("cannot start {}: {}\n", request.argv[0], std::strerror(error)));
    return sink.Finish(kCannotStart);
  }
  const auto start = std::chrono::steady_clock::now();
  std::optional<StallWatch> stall;
  if (request.stall_limit) stall.emplace(*request.stall_limit);
  const auto over = [&] {  // one of the two limits is reached
    ProcessResult limits;
    limits.timed_out = request.time_limit && std::chrono::steady_clock::now() - start > *request.time_limit;
    limits.stalled = !limits.timed_out && stall && stall->HasStalled(*child.group());
    return limits;
  };
  ChildStreams streams(&child, &sink);
  // A grandchild that lives on may hold a pipe open: once the child has ended, only what is there is read.
  bool ended = false;
  while (!ended || (streams.open() && streams.Serve(0))) {
    ThrowIfInterrupted();
    if (const ProcessResult limits = over(); limits.timed_out || limits.stalled) {
      child.group()->End();
      ProcessResult result = sink.Finish(child.group()->exit_code());
      result.timed_out = limits.timed_out, result.stalled = limits.stalled;
      return result;
    }
    if (request.while_running) request.while_running();
    if (ended) continue;
    if (!streams.open()) {  // it may close them long before it ends
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    } else if (streams.Serve(kPollMilliseconds)) {
      if (stall) stall->NoteSign();
      continue;
    }
    ended = child.group()->HasEnded();
    if (ended) streams.StopInput();
  }
  child.group()->End();
  return sink.Finish(child.group()->exit_code());
}

ProcessResult RunProcess(const std::vector<std::string>& argv, const fs::path& log,
                         const std::function<void(const std::string& line)>& on_line) {
  return RunProcess({.argv = argv, .log = log, .on_line = on_line});
}

bool WasKilled(int exit_code) {
  const int signal = exit_code - kKilledBySignal;
  return signal == SIGKILL || signal == SIGTERM || signal == SIGINT || signal == SIGHUP;
}

std::chrono::duration<double> StallLimit() {
  constexpr double kDefault = 120;
  const char* text = std::getenv("ORACLEGS_STALL_LIMIT");
  const double seconds = text ? std::strtod(text, nullptr) : 0;
  return std::chrono::duration<double>(seconds > 0 && seconds < 1e9 ? seconds : kDefault);
}

}  // namespace oraclegs
