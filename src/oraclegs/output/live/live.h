#pragma once
// Files that show a run while it goes on: OUT/live/ and OUT/train.csv.

#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/core/folder_lock.h"
#include "oraclegs/core/progress.h"
#include "oraclegs/gaussians/gaussians.h"
#include "oraclegs/output/live/curves.h"
#include "oraclegs/output/live/run_state.h"
#include "oraclegs/stages/run_observer.h"
#include "oraclegs/train/timings.h"
#include "oraclegs/workspace/workspace.h"

namespace oraclegs {

/// Decides when a snapshot is due, so that all of them together take less than a fiftieth of the training's time.
class SnapshotClock {
 public:
  /// `now` and `cost` are seconds of any one clock. The first snapshot is due at once; each next one 3 seconds after
  /// the end of the last, or 50 times the cost of the last, whichever is later.
  bool IsDue(double now) const { return now >= next_; }
  void Took(double end, double cost);

 private:
  double next_ = 0;
};

/// Writes Gaussians on any device to a .splat file, replacing it. Returns the seconds it took. Throws RunError.
double WriteSnapshot(const std::filesystem::path& path, const Gaussians& gaussians);

/// A run in 3D before it trains.
struct EarlySplat {
  std::string of;       ///< "sparse points", "dense points" or "draft model"
  Gaussians gaussians;  ///< empty = this stage has nothing new to show
};

/// Shows a stage that is finished: the points that it found as small Gaussians, at most 100 000 of them, or the first
/// proxy model.
EarlySplat EarlySplatOf(const Run& run, const std::string& stage);

/// Writes live/state.json at most twice a second, live/splat.splat while training, and train.csv. It holds a FolderLock
/// on live/, which tells a running run from one that was killed. It never changes a result or ends a run: a file that
/// cannot be written is one warning. The destructor writes the end of the run, or Guard when the run fails.
class Live final : public RunObserver {
 public:
  /// Writes documents where a run has more to show (RunObserver::Show).
  using Documents = std::function<void(Run* run, const std::string& stage)>;

  /// Observes a run that holds the workspace; events go on to `listener`. `documents` may be empty.
  Live(const WorkspacePaths& workspace, Listener listener, Documents documents = {});
  ~Live() override;
  Live(const Live&) = delete;
  Live& operator=(const Live&) = delete;

  /// Listener that is valid while this object lives.
  Listener AsListener();
  void Show(Run* run, const std::string& stage) override;
  TrainObserver OfTraining(TestScore score) override;
  void Guard(FunctionRef<void()> body) override;

 private:
  void On(const Event& event);
  void OnMoment(const TrainMoment& moment);
  /// Begins the means of the next row.
  void BeginRow(const TrainMoment& moment);
  void AddRow(const TrainMoment& moment);
  void TakeSnapshot(const TrainMoment& moment);
  void WriteState();
  void End(RunEnd end, const std::string& message);
  /// Writes something; a failure is warned of once a run.
  void Try(FunctionRef<void()> write);

  WorkspacePaths workspace_;
  Listener listener_;
  Documents documents_;
  std::filesystem::path splat_;
  std::optional<FolderLock> lock_;
  RunState state_;
  Stopwatch watch_;
  double state_due_ = 0;  ///< seconds of watch_
  std::vector<CurveRow> rows_;
  CurvesFile curves_;
  TestScore score_;
  /// Start of the iterations of the next row.
  struct {
    int64_t iteration = 0;
    double seconds = 0;
    TermSums terms = {};
  } since_;
  double looked_ = 0;      ///< time spent on observing since then, seconds; not part of an iteration
  bool training_ = false;  ///< set once the observer was called
  SnapshotClock snapshots_;
  nlohmann::json shown_splat_ = nullptr;
  bool warned_ = false;
  int exceptions_ = std::uncaught_exceptions();
};

}  // namespace oraclegs
