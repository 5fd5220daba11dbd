#include "oraclegs/experiments/launch/slurm_launcher.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <optional>
#include <set>
#include <thread>
#include <utility>

#include "oraclegs/core/files.h"
#include "oraclegs/core/folder_lock.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/text.h"
#include "oraclegs/experiments/launch/slurm_options.h"
#include "oraclegs/experiments/launch/slurm_record.h"
#include "oraclegs/experiments/launch/slurm_verdict.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using Ended = std::function<void(size_t job, const JobResult& result)>;

/// State of a job in this process.
struct Tracked {
  bool ended = false;                                  ///< ended and reported
  int attempt = 0;                                     ///< number of the running task, or of the next one
  std::optional<std::pair<size_t, size_t>> task = {};  ///< submission and place in it, while the task has not ended
  bool usable = true;                                  ///< false: it runs an old command, whose result is useless
  int looks = 0;                                       ///< SlurmEvidence::looks
};

/// One call of Run.
class SlurmRun {
 public:
  SlurmRun(const SlurmOptions& options, const fs::path& folder, const std::vector<Job>& jobs, SlurmPatience patience,
           const Listener& listener)
      : options_(options),
        folder_(folder),
        jobs_(jobs),
        patience_(patience),
        listener_(listener),
        tracked_(jobs.size()) {}

  void Run(const Ended& ended) {
    record_ = ReadSlurmRecord(folder_);
    try {
      FindLostArray();
      const size_t found = Adopt();
      if (found > 0) listener_(Note{fmt::format("found {} of an earlier start in Slurm", Counted(found, "job"))});
      while (true) {
        SubmitWaiting();
        Look(ended);
        if (std::all_of(tracked_.begin(), tracked_.end(), [](const Tracked& t) { return t.ended; })) return;
        Sleep();
      }
    } catch (const Interrupted&) {
      const std::string arrays = CancelAll();
      throw Interrupted(
          fmt::format("interrupted; {}the same command goes on with the jobs that are not done",
                      arrays.empty() ? "" : fmt::format("what was left of {} in Slurm was cancelled; ", arrays)));
    }
  }

 private:
  SlurmRecord::Task& TaskOf(const Tracked& tracked) {
    return record_.submissions[tracked.task->first].tasks[tracked.task->second];
  }
  SlurmTaskId IdOf(const Tracked& tracked) const {
    return {record_.submissions[tracked.task->first].array, static_cast<int>(tracked.task->second)};
  }
  void Save() { WriteSlurmRecord(folder_, record_); }

  /// Looks for the array of the last submission, whose number is unknown when sbatch did not answer or this process
  /// died while it ran. Only the last submission can be in that state.
  void FindLostArray() {
    if (record_.submissions.empty() || !record_.submissions.back().array.empty()) return;
    SlurmRecord::Submission& lost = record_.submissions.back();
    std::string array = ArrayOfStartedTasks(folder_ / lost.folder);
    if (array.empty()) {
      std::set<std::string> known;
      for (const SlurmRecord::Submission& other : record_.submissions) known.insert(other.array);
      for (const auto& [task, state] : QueueOfSlurm(record_.name, record_.cluster)) {
        if (known.count(task.array) == 0) array = task.array;
      }
    }
    if (array.empty()) {
      record_.submissions.pop_back();
    } else {
      lost.array = array;
    }
    Save();
  }

  /// Takes over open tasks of the record for jobs that have none, and cancels those with an old command. Returns their
  /// number.
  size_t Adopt() {
    std::map<std::string, std::pair<size_t, size_t>> open;
    for (size_t s = 0; s < record_.submissions.size(); ++s) {
      const std::vector<SlurmRecord::Task>& tasks = record_.submissions[s].tasks;
      for (size_t t = 0; t < tasks.size(); ++t) {
        if (tasks[t].open) open[tasks[t].job] = {s, t};
      }
    }
    std::vector<SlurmTaskId> old;
    size_t adopted = 0;
    for (size_t j = 0; j < jobs_.size(); ++j) {
      Tracked& tracked = tracked_[j];
      const auto found = open.find(jobs_[j].name);
      if (tracked.ended || tracked.task || found == open.end()) continue;
      ++adopted;
      tracked.task = found->second;
      SlurmRecord::Task& task = TaskOf(tracked);
      tracked.usable = task.command == SlurmCommandDigest(jobs_[j]);
      tracked.attempt = tracked.usable ? task.attempt : 0;
      if (tracked.usable || task.cancelled) continue;
      task.cancelled = true;
      old.push_back(IdOf(tracked));
    }
    CancelInSlurm(record_.name, old, record_.cluster);
    if (!old.empty()) Save();
    return adopted;
  }

  size_t Running() const {
    return static_cast<size_t>(
        std::count_if(tracked_.begin(), tracked_.end(), [](const Tracked& t) { return t.task.has_value(); }));
  }

  void SubmitWaiting() {
    if (!Try(queue_fails_since_, [&] { FindLostArray(); })) return;
    Adopt();
    std::vector<size_t> waiting;
    for (size_t j = 0; j < jobs_.size(); ++j) {
      if (!tracked_[j].ended && !tracked_[j].task) waiting.push_back(j);
    }
    const SlurmArrays arrays = PlanSlurmArrays(waiting.size(), Running(), static_cast<size_t>(options_.max_running));
    auto begin = waiting.begin();
    for (const size_t size : arrays.sizes) {
      const auto end = begin + static_cast<std::ptrdiff_t>(size);
      if (!Submit({begin, end}, arrays.throttle)) return;
      begin = end;
    }
  }

  bool Submit(const std::vector<size_t>& jobs, size_t throttle) {
    const size_t s = record_.submissions.size();
    SlurmRecord::Submission submission{.array = {}, .folder = fmt::format("{:04}", s), .tasks = {}};
    std::vector<Job> commands;
    for (const size_t j : jobs) {
      commands.push_back(jobs_[j]);
      submission.tasks.push_back(
          {.job = jobs_[j].name, .command = SlurmCommandDigest(jobs_[j]), .attempt = tracked_[j].attempt});
    }
    const fs::path folder = folder_ / submission.folder;
    WriteSlurmTasks(folder, commands);
    record_.submissions.push_back(std::move(submission));
    Save();  // before sbatch: when this process dies meanwhile, the next one looks for the array by its name

    std::string array = fmt::format("--array=0-{}", jobs.size() - 1);
    if (throttle > 0) array += fmt::format("%{}", throttle);
    // A second start by Slurm itself would not count as a try.
    std::vector<std::string> arguments = {"--job-name=" + record_.name, array, "--no-requeue", "--open-mode=append",
                                          "--output=" + SlurmOutputPattern(folder)};
    for (const std::string& argument : SbatchArguments(options_)) arguments.push_back(argument);
    arguments.push_back((folder / "batch.sh").string());
    SlurmArray submitted;
    if (!Try(sbatch_fails_since_, [&] { submitted = SubmitToSlurm(arguments); })) return false;
    sbatch_fails_since_.reset();
    record_.submissions[s].array = submitted.id;
    record_.cluster = submitted.cluster;
    Save();
    for (size_t t = 0; t < jobs.size(); ++t) tracked_[jobs[t]].task = {s, t}, tracked_[jobs[t]].usable = true;
    listener_(Note{fmt::format("submitted {} to Slurm as array {}", Counted(jobs.size(), "job"), submitted.id)});
    return true;
  }

  void Look(const Ended& ended) {
    SlurmTaskStates queue;
    if (!Try(queue_fails_since_, [&] { queue = QueueOfSlurm(record_.name, record_.cluster); })) return;
    queue_fails_since_.reset();
    std::vector<SlurmEvidence> evidence(jobs_.size());
    std::set<std::string> arrays;
    for (size_t j = 0; j < jobs_.size(); ++j) {
      if (!tracked_[j].task) continue;
      const auto& [s, t] = *tracked_[j].task;
      evidence[j].file = ReadSlurmTaskEnd(folder_ / record_.submissions[s].folder, static_cast<int>(t));
      evidence[j].looks = tracked_[j].looks;
      const auto found = queue.find(IdOf(tracked_[j]));
      if (found != queue.end()) evidence[j].queue = found->second;
      // A task that an earlier process cancelled will not report any more.
      if (found == queue.end() && TaskOf(tracked_[j]).cancelled) evidence[j].looks = kSlurmFileLooks;
      if (found != queue.end() && !found->second.reason.empty()) ReportReason(found->second.reason);
      if (HasEndedInSlurm(evidence[j])) arrays.insert(record_.submissions[s].array);
    }
    const auto accounts = AccountsOfSlurm({arrays.begin(), arrays.end()}, record_.cluster);
    for (size_t j = 0; j < jobs_.size(); ++j) {
      if (!tracked_[j].task) continue;
      if (accounts) {
        const auto found = accounts->find(IdOf(tracked_[j]));
        if (found != accounts->end()) evidence[j].accounts = found->second;
      }
      const std::optional<JobResult> result = SlurmVerdict(evidence[j], OutputOf(j));
      if (result) {
        TakeEnd(j, *result, ended);
      } else if (HasEndedInSlurm(evidence[j]) || evidence[j].file) {
        ++tracked_[j].looks;
      }
    }
  }

  /// Output of a job with a task: its log, or the file in which the batch script says why there is none.
  fs::path OutputOf(size_t j) const {
    const auto& [s, t] = *tracked_[j].task;
    std::error_code ignored;
    fs::path log = fs::absolute(jobs_[j].log);
    if (fs::is_regular_file(log, ignored)) return log;
    return SlurmOutput(folder_ / record_.submissions[s].folder, static_cast<int>(t));
  }

  void TakeEnd(size_t j, const JobResult& result, const Ended& ended) {
    Tracked& tracked = tracked_[j];
    SlurmRecord::Task& task = TaskOf(tracked);
    const bool given_up = task.cancelled && result.end != JobEnd::kDone;  // cancelled by an earlier process
    if (tracked.usable && !given_up) {
      if (IsWorthAnotherTry(result) && tracked.attempt < options_.retries) {
        ++tracked.attempt;
        listener_(Note{fmt::format("{} {}; is submitted again, {} of {}", jobs_[j].name, result.why, tracked.attempt,
                                   options_.retries)});
      } else {
        tracked.ended = true;
        Report(j, result, ended);
      }
    }
    // After the report: when this process dies in between, the next one reports the end again, instead of never.
    task.open = false, tracked.task.reset(), tracked.looks = 0;
    Save();
  }

  void Report(size_t j, const JobResult& result, const Ended& ended) {
    try {
      ended(j, result);
    } catch (...) {
      CancelAll();
      throw;
    }
  }

  /// Warns once of an unusual reason that holds the whole array up.
  void ReportReason(const std::string& reason) {
    static const std::set<std::string> kUsual = {"Priority",        "Resources",   "JobArrayTaskLimit", "BeginTime",
                                                 "Prolog",          "Cleaning",    "Dependency",        "Licenses",
                                                 "NonZeroExitCode", "RaisedSignal"};
    if (kUsual.count(reason) == 0 && reported_.insert(reason).second) {
      listener_(
          Warning{fmt::format("jobs wait in Slurm's queue: {}; the cluster may not have what they ask for", reason)});
    }
  }

  /// Cancels all tasks. Returns "array 12" or "arrays 12 and 14", "" when nothing was left to cancel. Does not throw,
  /// since the caller is about to report another error.
  std::string CancelAll() {
    const bool asked = InterruptRequested();
    RequestInterrupt(false);  // otherwise it would end scancel, too
    std::vector<SlurmTaskId> tasks;
    std::set<std::string> arrays;
    try {
      FindLostArray();
      Adopt();
      for (Tracked& tracked : tracked_) {
        if (tracked.ended || !tracked.task || TaskOf(tracked).cancelled) continue;
        TaskOf(tracked).cancelled = true;
        tasks.push_back(IdOf(tracked));
        arrays.insert(tasks.back().array);
      }
      CancelInSlurm(record_.name, tasks, record_.cluster);
      Save();
    } catch (const Error& error) {
      listener_(Warning{
          fmt::format("jobs may still run, end them with 'scancel --name={}': {}", record_.name, error.what())});
    }
    if (asked) RequestInterrupt(true);
    if (arrays.empty()) return "";
    return fmt::format("array{} {}", arrays.size() == 1 ? "" : "s", fmt::join(arrays, ", "));
  }

  /// Runs a step. Returns false when a Slurm program fails while jobs run: it is tried again later. failing_since
  /// belongs to that program; an answer of another one does not reset it.
  template <class Step>
  bool Try(std::optional<Clock::time_point>& failing_since, Step&& step) {
    try {
      step();
      return true;
    } catch (const Interrupted&) {
      throw;
    } catch (const RunError& error) {
      if (Running() == 0) throw;
      if (!failing_since) {
        failing_since = Clock::now();
        listener_(Warning{fmt::format("{}; what was submitted goes on, and it is asked again", error.what())});
      }
      if (Clock::now() - *failing_since < patience_) return false;
      throw RunError("{}; what was submitted goes on, the same command finds it again", error.what());
    }
  }

  void Sleep() const {
    const auto until = Clock::now() + std::chrono::duration<double>(options_.poll_seconds);
    while (Clock::now() < until) {
      ThrowIfInterrupted();
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }

  const SlurmOptions& options_;
  const fs::path& folder_;
  const std::vector<Job>& jobs_;
  const SlurmPatience patience_;
  const Listener& listener_;
  SlurmRecord record_;
  std::vector<Tracked> tracked_;
  std::set<std::string> reported_;
  std::optional<Clock::time_point> sbatch_fails_since_, queue_fails_since_;
};

class SlurmLauncher : public Launcher {
 public:
  SlurmLauncher(const SlurmOptions& options, const fs::path& folder, SlurmPatience patience)
      : options_(options), folder_(fs::absolute(folder).lexically_normal()), patience_(patience) {
    CheckOptions(options_);
  }

  void Run(const std::vector<Job>& jobs, const Ended& ended, const Listener& listener) override {
    if (jobs.empty()) return;
    RequireSlurm();
    RequireWritableFolder(folder_);
    const FolderLock lock(folder_, std::chrono::seconds(5));  // programs of a killed process may still be ending
    if (lock.state() == FolderLock::State::kHeldByAnother) {
      throw RunError("{}: {} follows these jobs; wait for it or end it", folder_.string(), lock.holder());
    }
    SlurmRun(options_, folder_, jobs, patience_, listener).Run(ended);
  }

 private:
  SlurmOptions options_;
  fs::path folder_;
  SlurmPatience patience_;
};

}  // namespace

std::unique_ptr<Launcher> MakeSlurmLauncher(const SlurmOptions& options, const fs::path& folder,
                                            SlurmPatience patience) {
  return std::make_unique<SlurmLauncher>(options, folder, patience);
}

}  // namespace oraclegs
