#include "oraclegs/experiments/launch/local_launcher.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <fstream>
#include <list>
#include <memory>
#include <thread>

#include "oraclegs/core/error.h"
#include "oraclegs/core/host.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/process_group.h"
#include "oraclegs/core/subprocess.h"
#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kPollInterval{20};
constexpr int64_t kTailBytes = 4096;

/// Number of processes that the kernel has ended for their memory since it started; -1 = not known.
int64_t KernelKills() {
  std::ifstream counters("/proc/vmstat");
  std::string name;
  for (int64_t value = 0; counters >> name >> value;) {
    if (name == "oom_kill") return value;
  }
  return -1;
}

/// Last line that is not blank in the log from byte `begin` on.
std::string LastLine(const fs::path& log, int64_t begin) {
  std::ifstream file(log, std::ios::binary);
  file.seekg(0, std::ios::end);
  const int64_t end = file.tellg();
  if (end <= begin) return "";
  std::string tail(static_cast<size_t>(std::min(end - begin, kTailBytes)), '\0');
  file.seekg(end - static_cast<int64_t>(tail.size()));
  file.read(tail.data(), static_cast<std::streamsize>(tail.size()));
  tail.erase(tail.find_last_not_of(" \t\r\n") + 1);
  const size_t newline = tail.find_last_of("\r\n");
  return OneLine(newline == std::string::npos ? tail : tail.substr(newline + 1));
}

/// Log of a job, open for appending.
class JobLog {
 public:
  explicit JobLog(fs::path path) : path_(std::move(path)) {
    std::error_code ignored;  // opening the file reports the fault
    fs::create_directories(path_.parent_path(), ignored);
    file_ = open(path_.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (file_ < 0) problem_ = fmt::format("{}: cannot write: {}", path_.string(), SystemReason(errno));
    if (file_ >= 0) begin_ = lseek(file_, 0, SEEK_END);
  }
  ~JobLog() {
    if (file_ >= 0) close(file_);
  }
  JobLog(const JobLog&) = delete;
  JobLog& operator=(const JobLog&) = delete;

  int file() const { return file_; }
  const std::string& problem() const { return problem_; }
  std::string LastLine() const { return oraclegs::LastLine(path_, begin_); }

 private:
  fs::path path_;
  int file_ = -1;
  int64_t begin_ = 0;
  std::string problem_;
};

/// A running job, which ends with the object.
class RunningJob {
 public:
  RunningJob(size_t number, size_t worker, const Job& job, const std::string& gpu)
      : number_(number), worker_(worker), log_(job.log), kernel_kills_(KernelKills()) {
    if (!log_.problem().empty()) return;
    std::vector<std::pair<std::string, std::string>> variables;
    if (!gpu.empty()) variables.emplace_back("CUDA_VISIBLE_DEVICES", gpu);
    group_ = std::make_unique<ProcessGroup>(ProgramStart{job.command, variables, -1, log_.file(), log_.file()});
    if (group_->start_error() == 0) return;
    problem_ = fmt::format("cannot start {}: {}", job.command.front(), SystemReason(group_->start_error()));
    group_.reset();
  }

  size_t number() const { return number_; }
  size_t worker() const { return worker_; }
  bool HasEnded() const { return !group_ || group_->HasEnded(); }

  /// Result of a job that has ended.
  JobResult Result() {
    JobResult result;
    result.seconds = std::chrono::duration<double>(Clock::now() - begin_).count();
    if (!group_) {
      result.end = JobEnd::kFailed, result.exit_code = kCannotStart;
      result.why = problem_.empty() ? log_.problem() : problem_;
      return result;
    }
    group_->End();
    result.exit_code = group_->exit_code(), result.peak_bytes = group_->peak_bytes();
    if (result.exit_code == 0) return result;
    const std::string line = log_.LastLine();
    result.end = EndOfChild(result.exit_code, MemoryWasShort(result.peak_bytes), line);
    result.why = WhyOf(result, line);
    return result;
  }

 private:
  /// True when memory is the likely reason for a kill. Without the kernel's count: when the job took more than half of
  /// what is free after it.
  bool MemoryWasShort(int64_t peak_bytes) const {
    const int64_t kills = KernelKills();
    if (kills >= 0 && kernel_kills_ >= 0) return kills > kernel_kills_;
    return 2 * peak_bytes > static_cast<int64_t>(AvailableMemory());
  }

  static std::string WhyOf(const JobResult& result, const std::string& line) {
    if (result.exit_code <= kKilledBySignal) {
      return line.empty() ? fmt::format("exit code {}, without a word", result.exit_code) : line;
    }
    const int signal = result.exit_code - kKilledBySignal;
    if (result.end != JobEnd::kOutOfMemory) return fmt::format("was ended by signal {}", signal);
    return fmt::format("was ended by the kernel for its memory, of which it had {:.1f} GB",
                       Gigabytes(result.peak_bytes));
  }

  size_t number_, worker_;
  JobLog log_;
  std::unique_ptr<ProcessGroup> group_;
  std::string problem_;
  int64_t kernel_kills_;
  Clock::time_point begin_ = Clock::now();
};

}  // namespace

JobEnd EndOfChild(int exit_code, bool memory_was_short, std::string_view last_line) {
  if (exit_code == 0) return JobEnd::kDone;
  const int signal = exit_code - kKilledBySignal;
  if (signal == SIGKILL) return memory_was_short ? JobEnd::kOutOfMemory : JobEnd::kFailed;
  if (signal == SIGINT || signal == SIGTERM || signal == SIGHUP) return JobEnd::kCancelled;
  return last_line.find("out of memory") != std::string_view::npos ? JobEnd::kOutOfMemory : JobEnd::kFailed;
}

void LocalLauncher::Run(const std::vector<Job>& jobs,
                        const std::function<void(size_t job, const JobResult& result)>& ended,
                        const Listener& listener) {
  std::list<RunningJob> running;
  std::vector<bool> busy(static_cast<size_t>(std::max(workers_.count, 1)), false);
  const auto start = [&](size_t job) {
    const auto worker = static_cast<size_t>(std::find(busy.begin(), busy.end(), false) - busy.begin());
    busy[worker] = true;
    listener(Note{fmt::format("{}: starts, its output is in {}", jobs[job].name, jobs[job].log.string())});
    running.emplace_back(job, worker, jobs[job],
                         workers_.gpus.empty() ? "" : workers_.gpus[worker % workers_.gpus.size()]);
  };
  for (size_t next = 0; next < jobs.size() || !running.empty();) {
    ThrowIfInterrupted();
    while (next < jobs.size() && running.size() < busy.size()) start(next++);
    const auto done = std::find_if(running.begin(), running.end(), [](const auto& job) { return job.HasEnded(); });
    if (done == running.end()) {
      std::this_thread::sleep_for(kPollInterval);
      continue;
    }
    const JobResult result = done->Result();
    const size_t job = done->number();
    busy[done->worker()] = false;
    running.erase(done);
    ended(job, result);
  }
}

}  // namespace oraclegs
