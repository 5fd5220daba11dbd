#pragma once
// What a run writes for those that look on: OUT/live/ and OUT/train.csv.

#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/core/folder_lock.h"
#include "oraclegs/core/progress.h"
#include "oraclegs/output/live/curves.h"
#include "oraclegs/output/live/run_state.h"
#include "oraclegs/output/live/snapshots.h"
#include "oraclegs/stages/run_observer.h"
#include "oraclegs/train/timings.h"
#include "oraclegs/workspace/workspace.h"

namespace oraclegs {

/// Writes live/state.json at most twice a second, live/splat.splat while training, and train.csv. It holds a
/// FolderLock on live/: a run that was killed is known by that. Nothing of it changes a result or ends a run: a file
/// that cannot be written is one warning. The end of the run is written by the destructor, or by Guard when it fails.
class Live final : public RunObserver {
 public:
  /// For a run that holds the workspace; events go on to `listener`.
  Live(const WorkspacePaths& workspace, Listener listener);
  ~Live() override;
  Live(const Live&) = delete;
  Live& operator=(const Live&) = delete;

  /// Valid as long as this object lives, as the observer.
  Listener AsListener();
  TrainObserver OfTraining(TestScore score) override;
  void Guard(FunctionRef<void()> body) override;

 private:
  void On(const Event& event);
  void OnMoment(const TrainMoment& moment);
  /// Begins the mean of the next row.
  void BeginRow(const TrainMoment& moment);
  void AddRow(const TrainMoment& moment);
  void TakeSnapshot(const TrainMoment& moment);
  void WriteState();
  void End(RunEnd end, const std::string& message);
  /// Writes something; what fails is warned of once a run.
  void Try(FunctionRef<void()> write);

  WorkspacePaths workspace_;
  Listener listener_;
  std::filesystem::path splat_;
  std::optional<FolderLock> lock_;
  RunState state_;
  Stopwatch watch_;
  double state_due_ = 0;  ///< seconds of watch_
  std::vector<CurveRow> rows_;
  CurvesFile curves_;
  TestScore score_;
  /// Where the iterations of the next row begin.
  struct {
    int64_t iteration = 0;
    double seconds = 0;
    TermSums terms = {};
  } since_;
  double looked_ = 0;      ///< seconds of looking on since then, which are no part of an iteration
  bool training_ = false;  ///< the observer was called
  SnapshotClock snapshots_;
  nlohmann::json shown_splat_ = nullptr;
  bool warned_ = false;
  int exceptions_ = std::uncaught_exceptions();
};

}  // namespace oraclegs
