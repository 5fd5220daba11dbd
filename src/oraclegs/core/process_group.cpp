#include "oraclegs/core/process_group.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string_view>
#include <thread>

#include "oraclegs/core/files.h"
#include "oraclegs/core/folder_lock.h"

namespace oraclegs {
namespace fs = std::filesystem;
namespace {

constexpr std::chrono::milliseconds kPatience{3000};  // between SIGTERM and SIGKILL

struct ProcessState {
  char state = 0;
  int64_t ticks = 0;  // of CPU time, with those of children that were waited for
};

/// Hands each process of a group to `take`, as the kernel describes it.
template <class Take>
void ForEachOfGroup(pid_t group, const Take& take) {
  std::error_code error;
  for (fs::directory_iterator it("/proc", error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    std::string stat;
    std::getline(std::ifstream(it->path() / "stat"), stat);
    const size_t after_name = stat.rfind(')');
    if (after_name == std::string::npos) continue;
    std::istringstream fields(stat.substr(after_name + 1));
    ProcessState process;
    int64_t parent = 0, member_of = 0, passed_over = 0, ticks = 0;
    fields >> process.state >> parent >> member_of;
    if (member_of != group) continue;
    for (int i = 0; i < 8; ++i) fields >> passed_over;
    for (int i = 0; i < 4 && fields >> ticks; ++i) process.ticks += ticks;
    take(process);
  }
}

/// True when a process of the group runs; those that ended and wait for their parent do not.
bool HasRunning(pid_t group) {
  if (kill(-group, 0) != 0) return false;
  bool running = false;
  ForEachOfGroup(group, [&](const ProcessState& p) { running = running || (p.state != 'Z' && p.state != 'X'); });
  return running;
}

// The functions below run in a child between fork and exec, where only calls are allowed that need no lock: another
// thread may have held one. For a program that is started, they run in the memory of this process (vfork).

/// A copy that stands above the three standard descriptors, one of which may be closed in this process.
int Above(int fd) { return fcntl(fd, F_DUPFD_CLOEXEC, 3); }

struct Exec {
  const char* file;
  char* const* arguments;
  char* const* environment;
  int input, output, errors;
  int guard;  // learns the number of the group from this pipe, before the program can start others
  pid_t parent;
};

/// All that must be so before the program begins; false and errno where it cannot be.
bool PrepareProgram(const Exec& exec) {
  if (setpgid(0, 0) != 0) return false;
  const pid_t group = getpid();
  if (write(exec.guard, &group, sizeof(group)) != sizeof(group)) return false;
  if (prctl(PR_SET_PDEATHSIG, SIGKILL) != 0) return false;
  if (getppid() != exec.parent) _exit(1);  // it died before the line above
  const int given[] = {exec.input >= 0 ? exec.input : open("/dev/null", O_RDONLY | O_CLOEXEC), exec.output,
                       exec.errors};
  int standard[] = {-1, -1, -1};
  for (int i = 0; i < 3; ++i) {
    if (given[i] >= 0 && (standard[i] = Above(given[i])) < 0) return false;
  }
  for (int i = 0; i < 3; ++i) {
    if (standard[i] >= 0 && dup2(standard[i], i) != i) return false;
  }
  // The child need not handle or ignore the signals that we do; but one that was ignored for both (nohup) stays so.
  struct sigaction usual {};
  usual.sa_handler = SIG_DFL;
  for (const int signal : {SIGINT, SIGTERM, SIGPIPE, SIGXFSZ}) sigaction(signal, &usual, nullptr);
  struct sigaction hangup {};
  if (sigaction(SIGHUP, nullptr, &hangup) == 0 && hangup.sa_handler != SIG_IGN) sigaction(SIGHUP, &usual, nullptr);
  sigset_t none;
  sigemptyset(&none);
  return sigprocmask(SIG_SETMASK, &none, nullptr) == 0;
}

[[noreturn]] void BecomeProgram(const Exec& exec, int report) {
  if (PrepareProgram(exec)) execve(exec.file, exec.arguments, exec.environment);
  const int error = errno;
  [[maybe_unused]] const ssize_t written = write(report, &error, sizeof(error));
  _exit(127);
}

/// Closes the open files of /proc/self/fd from `first` to `last`; false where that folder cannot be read.
bool CloseListed(unsigned first, unsigned last) {
  const int folder = open("/proc/self/fd", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return false;
  alignas(8) char entries[4096];  // of the kernel: inode (8 bytes), offset (8), length (2), type (1), name
  long filled = 0;
  while ((filled = syscall(SYS_getdents64, folder, entries, sizeof(entries))) > 0) {
    for (long at = 0; at < filled;) {
      unsigned short length = 0;
      std::memcpy(&length, entries + at + 16, sizeof(length));
      unsigned fd = 0;
      const char* digit = entries + at + 19;
      for (; *digit >= '0' && *digit <= '9'; ++digit) fd = fd * 10 + static_cast<unsigned>(*digit - '0');
      const bool is_number = digit != entries + at + 19;
      if (is_number && fd >= first && fd <= last && fd != static_cast<unsigned>(folder)) close(static_cast<int>(fd));
      at += length;
    }
  }
  close(folder);
  return filled == 0;
}

/// Closes open files, `first` and `last` among them, also where the kernel or a container's filter has no close_range.
void CloseRange(unsigned first, unsigned last) {
  if (close_range(first, last, 0) == 0 || CloseListed(first, last)) return;
  constexpr rlim_t kMaxTried = 1 << 20;
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) limit.rlim_cur = kMaxTried;
  const auto end = static_cast<unsigned>(std::min<rlim_t>({limit.rlim_cur, kMaxTried, rlim_t{last} + 1}));
  for (unsigned fd = first; fd < end; ++fd) close(static_cast<int>(fd));
}

/// The guard, which is there before the program: reads the number of the group from `pipe[0]`, waits until the other
/// end is closed, which this process's death does, and ends the group. It closes all open files but `kept`, which are
/// ascending and have the pipe among them: the locks, until nothing of the group is left.
[[noreturn]] void GuardGroup(const int (&pipe)[2], const std::vector<int>& kept) {
  close(pipe[1]);  // or the end of the pipe would never come, whatever becomes of the lines below
  setpgid(0, 0);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE}) ::signal(signal, SIG_IGN);
  prctl(PR_SET_NAME, "guards-children");  // `pkill -9 oraclegs` must spare it
  unsigned first = 0;
  for (const int fd : kept) {
    const auto next = static_cast<unsigned>(fd);
    if (next > first) CloseRange(first, next - 1);
    first = next + 1;
  }
  CloseRange(first, ~0U);
  pid_t group = 0, number = 0;
  ssize_t n = 0;
  while ((n = read(pipe[0], &number, sizeof(number))) > 0 || (n < 0 && errno == EINTR)) {
    if (n == sizeof(number)) group = number;
  }
  if (group <= 0) _exit(0);
  constexpr timespec kPause{0, 10'000'000};
  constexpr int kTries = 500;
  for (int i = 0; i < kTries && kill(-group, SIGKILL) == 0; ++i) nanosleep(&kPause, nullptr);
  _exit(0);
}

// End of what runs in a child.

/// The number of the new process, or -1 and errno. It shares this process's memory until it is the program, which costs
/// nothing however much that is; no signal handler of ours runs in it.
pid_t StartChild(const Exec& exec, int report) {
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  const pid_t pid = vfork();  // NOLINT: the child only makes calls that a signal handler may make
  if (pid == 0) BecomeProgram(exec, report);
  const int error = errno;
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  errno = error;
  return pid;
}

/// The environment of this process with some variables set anew.
std::vector<std::string> Environment(const std::vector<std::pair<std::string, std::string>>& variables) {
  std::vector<std::string> texts;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string_view text = *variable;
    const bool replaced = std::any_of(variables.begin(), variables.end(), [&](const auto& own) {
      return text.size() > own.first.size() && text.starts_with(own.first) && text[own.first.size()] == '=';
    });
    if (!replaced) texts.emplace_back(text);
  }
  for (const auto& [name, value] : variables) texts.push_back(name + "=" + value);
  return texts;
}

std::vector<char*> Pointers(std::vector<std::string>* texts) {
  std::vector<char*> pointers;
  for (std::string& text : *texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

/// Starts the program, whose guard listens to the pipe `guard`; its number, or 0 and errno in *error.
pid_t StartProgram(const ProgramStart& start, int guard, int* error) {
  const fs::path program = FindProgram(start.argv[0]);
  *error = 0;
  if (program.empty()) {
    *error = start.argv[0].find('/') != std::string::npos && access(start.argv[0].c_str(), F_OK) == 0 ? EACCES : ENOENT;
    return 0;
  }
  std::vector<std::string> argv = start.argv, environment = Environment(start.variables);
  const std::vector<char*> arguments = Pointers(&argv), variables = Pointers(&environment);
  const std::string file = program.string();
  const Exec exec{file.c_str(), arguments.data(), variables.data(), start.input, start.output, start.errors,
                  guard,        getpid()};
  int report[2];
  if (pipe2(report, O_CLOEXEC) != 0) {
    *error = errno;
    return 0;
  }
  const int report_end = Above(report[1]);
  const pid_t pid = report_end < 0 ? -1 : StartChild(exec, report_end);
  if (pid < 0) *error = errno;
  close(report[1]);
  if (report_end >= 0) close(report_end);
  int failed = 0;
  ssize_t n = 0;
  while (pid > 0 && (n = read(report[0], &failed, sizeof(failed))) < 0 && errno == EINTR) continue;
  close(report[0]);
  if (pid < 0) return 0;
  if (n != sizeof(failed)) return pid;
  *error = failed;
  while (waitpid(pid, nullptr, 0) < 0 && errno == EINTR) continue;
  return 0;
}

}  // namespace

ProcessGroup::ProcessGroup(const ProgramStart& start) {
  int guard_pipe[2];
  if (pipe2(guard_pipe, O_CLOEXEC) != 0) {
    start_error_ = errno;
    return;
  }
  std::vector<int> kept = HeldFolderLocks();
  kept.push_back(guard_pipe[0]);
  std::sort(kept.begin(), kept.end());
  guard_ = fork();
  if (guard_ == 0) GuardGroup(guard_pipe, kept);
  if (guard_ < 0) {
    start_error_ = errno;
  } else {
    program_ = StartProgram(start, guard_pipe[1], &start_error_);
    if (program_ > 0) setpgid(program_, program_);  // the child does the same: whoever comes first
  }
  close(guard_pipe[0]);
  guard_pipe_ = guard_pipe[1];
  if (start_error_ != 0) End();
}

bool ProcessGroup::HasEnded() const {
  if (program_ <= 0) return true;
  siginfo_t info{};
  // It is not waited for yet: its number stays that of the group.
  return waitid(P_PID, static_cast<id_t>(program_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid == program_;
}

void ProcessGroup::End() {
  if (program_ > 0) {
    if (HasRunning(program_)) {
      kill(-program_, SIGTERM);
      const auto deadline = std::chrono::steady_clock::now() + kPatience;
      while (HasRunning(program_) && std::chrono::steady_clock::now() < deadline) {
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      }
      kill(-program_, SIGKILL);
    }
  }
  if (guard_ > 0) {  // before the group's number is free for others
    kill(guard_, SIGKILL);
    while (waitpid(guard_, nullptr, 0) < 0 && errno == EINTR) continue;
  }
  if (guard_pipe_ >= 0) close(guard_pipe_);
  if (program_ > 0) {
    rusage usage{};
    while (wait4(program_, &status_, 0, &usage) < 0 && errno == EINTR) continue;
    peak_bytes_ = int64_t{usage.ru_maxrss} * 1024;
  }
  program_ = guard_ = 0;
  guard_pipe_ = -1;
}

int ProcessGroup::exit_code() const {
  return WIFEXITED(status_) ? WEXITSTATUS(status_) : kKilledBySignal + WTERMSIG(status_);
}

double ProcessGroup::CpuSeconds() const {
  int64_t ticks = 0;
  if (program_ > 0) ForEachOfGroup(program_, [&](const ProcessState& process) { ticks += process.ticks; });
  return static_cast<double>(ticks) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

}  // namespace oraclegs
