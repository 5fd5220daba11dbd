#include "oraclegs/experiments/bench/bench.h"

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>

#include "oraclegs/core/files.h"
#include "oraclegs/core/folder_lock.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/text.h"
#include "oraclegs/experiments/ablation.h"
#include "oraclegs/experiments/bench/bench_plot.h"
#include "oraclegs/experiments/bench/bench_report.h"
#include "oraclegs/experiments/bench/run_order.h"
#include "oraclegs/experiments/bench/run_record.h"
#include "oraclegs/experiments/series.h"
#include "oraclegs/settings/plan.h"
#include "oraclegs/stages/stage_works.h"
#include "oraclegs/workspace/stage_records.h"
#include "oraclegs/workspace/stage_sharing.h"
#include "oraclegs/workspace/workspace.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr char kBenchJson[] = "bench.json", kBenchMarkdown[] = "bench.md", kBenchLatex[] = "bench.tex",
               kBenchCsv[] = "bench.csv";
// Children of a call that was killed may take seconds to end and hold its lock meanwhile.
constexpr std::chrono::seconds kLockPatience{15};
constexpr char kViewsPlot[] = "bench-views.svg", kTimePlot[] = "bench-time.svg", kBenchRuns[] = "runs";

/// Cause in the program's last line: "what happened" of "... error: what happened".
std::string Reason(const std::string& why) {
  constexpr std::string_view kError = "oraclegs: error: ";
  return why.starts_with(kError) ? why.substr(kError.size()) : why;
}

class Bench {
 public:
  Bench(const BenchRequest& request, const BenchPlan& plan, Launcher* launcher, const Listener& listener)
      : request_(request),
        plan_(plan),
        launcher_(launcher),
        listener_(listener),
        lock_(Claim(request, plan), kLockPatience),
        order_(plan) {
    if (lock_.state() == FolderLock::State::kHeldByAnother) {
      throw RunError("{}: another `oraclegs bench` works there ({}); wait for it, or choose another folder with -o",
                     request.out.string(), lock_.holder());
    }
    report_ = NewReport();
    known_seconds_.resize(plan.methods.size());
    if (request.overwrite) RemoveRuns(request, plan, listener);
    for (size_t r = 0; r < plan.runs.size(); ++r) FindState(r);
  }

  BenchReport Run() {
    Write();
    const auto pending = Pending();
    if (pending.size() < plan_.runs.size()) {
      listener_(Note{fmt::format("{} of {} runs are done or cannot be run", plan_.runs.size() - pending.size(),
                                 plan_.runs.size())});
    }
    for (std::vector<size_t> left = pending; !left.empty(); left = Pending()) {
      Launch(order_.Ready(left, tried_,
                          {[&](size_t r) { return HasDonor(r); }, [&](size_t r) { return HasDonorOfProposals(r); }}));
    }
    for (const char* file : {kBenchJson, kBenchMarkdown, kBenchLatex, kBenchCsv, kViewsPlot, kTimePlot}) {
      listener_(FileWritten{request_.out / file});
    }
    RequireScores();
    return std::move(report_);
  }

 private:
  /// Makes the folder; refuses one that holds anything else.
  static fs::path Claim(const BenchRequest& request, const BenchPlan& plan) {
    for (const SceneCheck& check : plan.checks) RequireOutsideScene(request.out, check.scene.path);
    RequireSeriesFolder(request.out, {"benchmark",
                                      kBenchJson,
                                      {kBenchRuns, kSlurmFolder, kBenchJson, kBenchMarkdown, kBenchLatex, kBenchCsv,
                                       kViewsPlot, kTimePlot}});
    RequireWritableFolder(request.out);
    return request.out;
  }

  BenchReport NewReport() const {
    BenchReport report;
    report.suite = plan_.suite.name, report.label = plan_.suite.label;
    report.command = request_.command, report.version = request_.version;
    report.views = plan_.views, report.seeds = plan_.seeds, report.compares = plan_.keeps_protocol;
    for (const Method& method : plan_.methods) report.methods.push_back({method.name, method.label, method.citation});
    for (const SceneCheck& check : plan_.checks) {
      if (report.scenes.empty() || report.scenes.back() != check.scene.name) report.scenes.push_back(check.scene.name);
    }
    for (const BenchRun& run : plan_.runs) {
      const SceneCheck& check = plan_.checks[run.check];
      BenchScore score;
      score.scene = check.scene.name, score.views = check.views, score.method = plan_.methods[run.method].name;
      score.seed = run.seed, score.workspace = fmt::format("{}/{}", kBenchRuns, run.name);
      if (!check.problem.empty()) score.ended = true, score.failure = check.problem;
      report.runs.push_back(std::move(score));
    }
    if (!plan_.suite.is_folder() && !plan_.keeps_protocol) {
      report.notes.emplace_back(
          "Options change the images of the suite's protocol or their size: published scores do not compare, and none "
          "are shown.");
    }
    return report;
  }

  bool CanRun(size_t r) const { return plan_.checks[plan_.runs[r].check].problem.empty(); }
  fs::path Workspace(size_t r) const { return WorkspaceOf(request_, plan_.runs[r]); }
  std::string SceneOf(size_t r) const {
    return fs::absolute(plan_.checks[plan_.runs[r].check].scene.path).lexically_normal().string();
  }

  /// Reads the state of a run that an earlier call did or began.
  void FindState(size_t r) {
    if (!CanRun(r)) return;
    const std::optional<RunRecord> record = ReadRunRecord(Workspace(r));
    if (!record) return;  // the run itself finds results without a record, or refuses them
    RequireSameRun(r, *record);
    if (ReadScore(Workspace(r), &report_.runs[r])) AddRecord(r, *record);
  }

  void RequireSameRun(size_t r, const RunRecord& record) const {
    std::string difference = DifferenceOf(record.arguments, AsRecorded(ResultArguments(plan_.runs[r].arguments)));
    const std::string scene = AsRecorded(SceneOf(r));
    if (record.scene != scene) difference = fmt::format("its scene was {}, now is {}", record.scene, scene);
    if (difference.empty()) return;
    throw InputError(
        "{}: was run with other options: {}; choose another folder with -o, or replace its runs with "
        "--overwrite",
        Workspace(r).string(), difference);
  }

  /// Adds a run's record to its score.
  void AddRecord(size_t r, const RunRecord& record) {
    BenchScore& score = report_.runs[r];
    score.version = record.version;
    auto& peak = score.value[static_cast<size_t>(BenchValue::kPeakBytes)];
    peak = std::max(peak.value_or(0), static_cast<double>(record.result.peak_bytes));
    if (record.result.seconds > 0) known_seconds_[plan_.runs[r].method] = record.result.seconds;
  }

  /// Runs that are neither done nor tried in this call.
  std::vector<size_t> Pending() const {
    std::vector<size_t> pending;
    for (size_t r = 0; r < plan_.runs.size(); ++r) {
      if (CanRun(r) && !report_.runs[r].ended && std::count(tried_.begin(), tried_.end(), r) == 0) pending.push_back(r);
    }
    return pending;
  }

  /// Workspaces whose geometry a run may copy.
  std::vector<fs::path> Donors(size_t r) const {
    std::vector<fs::path> donors;
    for (size_t other = 0; other < plan_.runs.size(); ++other) {
      if (other != r && order_.SharesGeometry(r, other) && IsWorkspace(Workspace(other)))
        donors.push_back(Workspace(other));
    }
    return donors;
  }

  bool HasDonor(size_t r) const {
    const std::vector<fs::path> donors = Donors(r);
    const bool needs_depth = order_.NeedsDepth(r);
    return std::any_of(donors.begin(), donors.end(), [&](const fs::path& donor) {
      const json records = ReadStageRecords(donor);
      return records.contains("depth") || (!needs_depth && records.contains("sfm"));
    });
  }

  std::vector<fs::path> DonorsOfProposals(size_t r) const {
    std::vector<fs::path> donors;
    for (size_t other = 0; other < plan_.runs.size(); ++other) {
      if (other != r && order_.SharesProposals(r, other) && IsWorkspace(Workspace(other)))
        donors.push_back(Workspace(other));
    }
    return donors;
  }

  bool HasDonorOfProposals(size_t r) const {
    const std::vector<fs::path> donors = DonorsOfProposals(r);
    return std::any_of(donors.begin(), donors.end(),
                       [](const fs::path& donor) { return ReadStageRecords(donor).contains("propose"); });
  }

  void Launch(const std::vector<size_t>& runs) {
    std::vector<Job> jobs;
    std::vector<size_t> run_of_job;
    for (const size_t r : runs) {
      ThrowIfInterrupted();
      tried_.push_back(r);
      if (!Prepare(r)) continue;
      jobs.push_back({plan_.runs[r].name, CommandOf(request_, plan_, plan_.runs[r]), LogFile(Workspace(r))});
      run_of_job.push_back(r);
    }
    if (jobs.empty()) return;
    launcher_->Run(
        jobs, [&](size_t job, const JobResult& result) { Take(run_of_job[job], result); }, listener_);
  }

  /// Records the run and copies geometry and proposals that another run has. False on failure.
  bool Prepare(size_t r) {
    const BenchRun& run = plan_.runs[r];
    WriteRunRecord(Workspace(r), {SceneOf(r), ResultArguments(run.arguments), request_.version, false, {}});
    try {
      // A task of an earlier call may still be running; the launcher finds it, and its workspace is its own.
      if (IsFolderLocked(Workspace(r)) || HasBegun(WorkspacePaths(Workspace(r)))) return true;
      const std::vector<fs::path> donors = Donors(r), donors_of_proposals = DonorsOfProposals(r);
      if (donors.empty() && donors_of_proposals.empty()) return true;
      RunOptions options = OptionsOf(run.arguments);
      options.split = WithListsRead(options.split);
      auto workspace = oraclegs::Workspace::Claim(Workspace(r), SceneOf(r), options, false);
      TakeOverGeometry(&workspace, donors);
      TakeOverProposals(&workspace, donors_of_proposals);
      return true;
    } catch (const InputError& error) {
      Fail(r, error.what());
      Write();
      return false;
    }
  }

  /// True when the run itself has written results. Its geometry and its record of options and size are kept then: it
  /// knows the networks it found and the photos it read.
  static bool HasBegun(const WorkspacePaths& paths) {
    std::error_code ignored;
    return fs::exists(paths.sfm(), ignored) || fs::exists(paths.depth(), ignored) || HasResults(paths);
  }

  void Fail(size_t r, const std::string& why) {
    report_.runs[r].ended = true;
    report_.runs[r].failure = why;
    listener_(Warning{fmt::format("{} failed: {}", plan_.runs[r].name, why)});
  }

  /// Records the end of a job.
  void Take(size_t r, const JobResult& result) {
    RunRecord record{SceneOf(r), ResultArguments(plan_.runs[r].arguments), request_.version, true, result};
    WriteRunRecord(Workspace(r), record);
    if (ReadScore(Workspace(r), &report_.runs[r])) {
      AddRecord(r, record);
      std::error_code ignored;  // gigabytes that nothing reads any more
      fs::remove_all(WorkspacePaths(Workspace(r)).checkpoints(), ignored);
    } else if (result.end == JobEnd::kCancelled) {
      listener_(Warning{fmt::format("{} was cancelled; the same command runs it again", plan_.runs[r].name)});
    } else {
      const std::string why = result.why.empty() ? "it wrote no scores" : Reason(result.why);
      Fail(r, fmt::format("{}{}", EndWord(result.end), why));
    }
    Write();
    Tell(r);
  }

  static const char* EndWord(JobEnd end) {
    if (end == JobEnd::kOutOfMemory) return "out of memory: ";
    return end == JobEnd::kOutOfTime ? "out of time: " : "";
  }

  void Tell(size_t r) {
    std::vector<size_t> left;
    for (size_t other = 0; other < plan_.runs.size(); ++other) {
      if (CanRun(other) && !report_.runs[other].ended) left.push_back(plan_.runs[other].method);
    }
    const BenchScore& score = report_.runs[r];
    const auto& psnr = score.value[static_cast<size_t>(BenchValue::kPsnr)];
    const std::string outcome = !score.ended             ? "cancelled"
                                : !score.failure.empty() ? "failed"
                                : psnr                   ? fmt::format("{:.2f} dB", *psnr)
                                                         : "no test pixels";
    const int workers = request_.workers;
    const double seconds = workers > 0 ? SecondsLeft(known_seconds_, left) / workers : 0;
    const auto ended =
        std::count_if(report_.runs.begin(), report_.runs.end(), [](const auto& run) { return run.ended; });
    listener_(Note{fmt::format("run {} of {} ({}): {}{}", ended, plan_.runs.size(), plan_.runs[r].name, outcome,
                               seconds > 0 ? fmt::format(", about {} left", FormatSeconds(seconds)) : "")});
  }

  void AddNote(std::string note) {
    auto& notes = report_.notes;
    if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(std::move(note));
  }

  /// Adds a note when different versions of this program made the runs.
  void NoteVersions() {
    const std::string* first = nullptr;
    for (const BenchScore& run : report_.runs) {
      if (!run.is_scored() || run.version.empty()) continue;
      if (!first) first = &run.version;
      if (run.version == *first) continue;
      AddNote("Runs were made by different versions of this program; bench.json and bench.csv have that of each.");
      return;
    }
  }

  /// Adds a note when LPIPS is not the one that papers score.
  void NoteLpips() {
    for (const BenchScore& run : report_.runs) {
      if (run.lpips.empty() || run.lpips.starts_with(kSuiteLpips)) continue;
      AddNote(fmt::format("LPIPS here is {}; papers score with {}.", run.lpips, kSuiteLpips));
    }
  }

  void Write() {
    NoteLpips();
    NoteVersions();
    const auto replace = json::error_handler_t::replace;
    WriteFileAtomically(request_.out / kBenchJson, BenchToJson(report_).dump(2, ' ', false, replace) + "\n");
    WriteFileAtomically(request_.out / kBenchMarkdown, BenchMarkdown(report_));
    WriteFileAtomically(request_.out / kBenchLatex, BenchLatex(report_));
    WriteFileAtomically(request_.out / kBenchCsv, BenchCsv(report_));
    WriteFileAtomically(request_.out / kViewsPlot, PsnrOverViews(report_));
    WriteFileAtomically(request_.out / kTimePlot, PsnrOverTime(report_));
  }

  void RequireScores() const {
    const auto& runs = report_.runs;
    if (std::any_of(runs.begin(), runs.end(), [](const BenchScore& run) { return run.is_scored(); })) return;
    for (size_t r = 0; r < runs.size(); ++r) {
      if (CanRun(r) && !runs[r].failure.empty()) {
        throw RunError("nothing was scored; {} failed: {}", plan_.runs[r].name, runs[r].failure);
      }
    }
    throw RunError("nothing was scored; all runs were cancelled");
  }

  const BenchRequest& request_;
  const BenchPlan& plan_;
  Launcher* launcher_;
  const Listener& listener_;
  FolderLock lock_;
  BenchReport report_;
  RunOrder order_;
  std::vector<double> known_seconds_;  ///< duration of the last run of each method; 0 = not known
  std::vector<size_t> tried_;          ///< runs tried in this call
};

}  // namespace

BenchReport RunBench(const BenchRequest& request, const BenchPlan& plan, Launcher* launcher, const Listener& listener) {
  return Bench(request, plan, launcher, listener).Run();
}

}  // namespace oraclegs
