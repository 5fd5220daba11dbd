#include "oraclegs/output/live/live.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/statistics.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/formats/codecs.h"
#include "oraclegs/stages/start_points.h"
#include "oraclegs/train/timings.h"

namespace oraclegs {
namespace {
namespace fs = std::filesystem;

constexpr double kStatePause = 0.5;  // seconds
constexpr double kStatePauseOfCost = 200;

fs::path DocumentOf(const WorkspacePaths& workspace) { return workspace.report() / "run.json"; }

/// True when a document has a trained splat. The document of a finished run does; the one that is written when training
/// begins does not.
bool HasTrainedSplat(const fs::path& document) {
  std::error_code ignored;
  if (!fs::exists(document, ignored)) return false;
  const nlohmann::json json = ParseJsonOrDiscard(ReadFile(document));
  return json.is_object() && json.value("finished", nlohmann::json()) == true;
}

constexpr double kMinPause = 3;  // seconds
constexpr double kPauseOfCost = 50;

constexpr size_t kMaxPoints = 100000;
constexpr double kOpacity = 0.95;
constexpr double kSparseScale = 0.2, kDenseScale = 0.5;  // of the neighbors' distance: dots apart, and a closed surface
constexpr float kMaxScale = 3;                           // times the median: points far from all others are no balloons

/// Evenly spaced in their list.
PointCloud Thinned(const PointCloud& cloud) {
  const size_t n = std::min(cloud.xyz.size(), kMaxPoints);
  PointCloud thinned;
  for (size_t i = 0; i < n; ++i) {
    const size_t from = i * cloud.xyz.size() / n;
    thinned.xyz.push_back(cloud.xyz[from]);
    thinned.rgb.push_back(cloud.rgb[from]);
  }
  return thinned;
}

Gaussians Dots(const PointCloud& cloud, double scale) {
  if (cloud.xyz.size() < 2) return {};
  Gaussians dots = InitializeGaussians(Thinned(cloud), {scale, kOpacity});
  std::vector<float> scales(dots.log_scales.data(), dots.log_scales.data() + 3 * dots.size());
  const float largest = UpperMedian(scales) + std::log(kMaxScale);
  for (int64_t i = 0; i < 3 * dots.size(); ++i) dots.log_scales[i] = std::min(dots.log_scales[i], largest);
  return dots;
}

}  // namespace

EarlySplat EarlySplatOf(const Run& run, const std::string& stage) {
  const StageResults& results = *run.results;
  if (stage == "sfm") return {"sparse points", Dots(ToPointCloud(results.points), kSparseScale)};
  if (stage == "depth") return {"dense points", Dots(ToPointCloud(results.geometry.points), kDenseScale)};
  if (stage == "proxies" && !results.proxies.empty()) return {"draft model", results.proxies.front().gaussians};
  return {};
}

Live::Live(const WorkspacePaths& workspace, Listener listener, Documents documents)
    : workspace_(workspace.root()),
      listener_(std::move(listener)),
      documents_(std::move(documents)),
      splat_(workspace.live() / "splat.splat"),
      curves_(workspace.curves()) {
  std::error_code ignored;
  fs::create_directory(workspace_.live(), ignored);
  fs::remove(splat_, ignored);  // left by a run that was killed
  lock_.emplace(workspace_.live());
  rows_ = ReadCurves(workspace_.curves());
  WriteState();
}

Live::~Live() {
  if (state_.ended()) return;
  if (std::uncaught_exceptions() > exceptions_) {
    End(RunEnd::kFailed, "the run ended with an error");
  } else {
    End(RunEnd::kFinished, "");
  }
}

Listener Live::AsListener() {
  return [this](const Event& event) { On(event); };
}

void Live::Show(Run* run, const std::string& stage) {
  if (documents_) Try([&] { documents_(run, stage); });
  const double start = watch_.Seconds();
  Try([&] {
    const EarlySplat early = EarlySplatOf(*run, stage);
    if (early.gaussians.size() == 0) return;
    WriteSnapshot(splat_, early.gaussians);
    shown_splat_ = {{"url", "live/splat.splat"},
                    {"format", "splat"},
                    {"of", early.of},
                    {"iteration", nullptr},
                    {"gaussians", early.gaussians.size()}};
  });
  looked_ += watch_.Seconds() - start;
  WriteState();
}

TrainObserver Live::OfTraining(TestScore score) {
  training_ = false;
  score_ = std::move(score);
  return [this](const TrainMoment& moment) {
    const double start = watch_.Seconds();
    OnMoment(moment);
    looked_ += watch_.Seconds() - start;
  };
}

void Live::Guard(FunctionRef<void()> body) {
  try {
    body();
  } catch (const Interrupted& error) {
    End(RunEnd::kInterrupted, error.what());
    throw;
  } catch (const std::bad_alloc&) {
    End(RunEnd::kFailed, "out of memory");
    throw;
  } catch (const std::exception& error) {
    End(RunEnd::kFailed, error.what());
    throw;
  }
}

void Live::On(const Event& event) {
  listener_(event);
  state_.Add(event);
  const bool stage = std::holds_alternative<StageStarted>(event) || std::holds_alternative<StageFinished>(event);
  if (stage || watch_.Seconds() >= state_due_) WriteState();
}

void Live::OnMoment(const TrainMoment& moment) {
  if (!std::exchange(training_, true)) {  // rows after the iteration that training continues from are dropped
    std::erase_if(rows_, [&](const CurveRow& row) { return row.iteration > moment.iteration; });
    Try([&] { curves_.Write(rows_); });
    BeginRow(moment);
  } else if (HasCurveRow(moment.iteration, moment.total) || score_.IsDue(moment.iteration, moment.total)) {
    AddRow(moment);
  }
  if (snapshots_.IsDue(watch_.Seconds()) || moment.iteration == moment.total) TakeSnapshot(moment);
  if (watch_.Seconds() >= state_due_) WriteState();
}

void Live::BeginRow(const TrainMoment& moment) {
  since_ = {moment.iteration, moment.seconds, moment.terms};
  looked_ = 0;
}

void Live::AddRow(const TrainMoment& moment) {
  CurveRow row;
  row.iteration = moment.iteration, row.gaussians = moment.gaussians.size();
  row.seconds = moment.seconds, row.loss = moment.loss();
  const auto iterations = static_cast<double>(moment.iteration - since_.iteration);
  row.milliseconds = std::max(0., moment.seconds - since_.seconds - looked_) * 1000 / iterations;
  row.SetTerms(moment.terms.Since(since_.terms));
  BeginRow(moment);
  if (score_.IsDue(moment.iteration, moment.total)) Try([&] { row.psnr = score_.psnr(moment.gaussians); });
  rows_.push_back(row);
  Try([&] { curves_.Append(rows_); });
}

void Live::TakeSnapshot(const TrainMoment& moment) {
  moment.loss();  // waits; the trainer, not the observer, reports a training that has diverged
  const double start = watch_.Seconds();
  double cost = -1;
  Try([&] { cost = WriteSnapshot(splat_, moment.gaussians); });
  const double end = watch_.Seconds();
  snapshots_.Took(end, cost < 0 ? end - start : cost);
  if (cost < 0) return;
  shown_splat_ = {{"url", "live/splat.splat"},
                  {"format", "splat"},
                  {"of", "training"},
                  {"iteration", moment.iteration},
                  {"gaussians", moment.gaussians.size()}};
  WriteState();
}

void Live::WriteState() {
  const double start = watch_.Seconds();
  std::error_code ignored;
  nlohmann::json state = state_.ToJson();
  state["updated"] = UtcNow();
  state["elapsed_seconds"] = watch_.Seconds();
  state["curves"] = rows_.empty() ? nlohmann::json::array() : CurvesToJson(rows_);
  state["splat"] = shown_splat_;
  state["lock"] = lock_->held();
  state["document"] = fs::exists(DocumentOf(workspace_), ignored);
  Try([&] {
    ReplaceFile(workspace_.live() / "state.json",
                state.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  });
  const double end = watch_.Seconds();
  state_due_ = end + std::max(kStatePause, kStatePauseOfCost * (end - start));
}

void Live::End(RunEnd end, const std::string& message) {
  if (state_.ended()) return;
  state_.SetEnd(end, message);
  std::error_code ignored;
  if (end == RunEnd::kFinished && HasTrainedSplat(DocumentOf(workspace_))) {
    shown_splat_ = nullptr;
    fs::remove(splat_, ignored);
  }
  WriteState();
}

void Live::Try(FunctionRef<void()> write) {
  try {
    write();
  } catch (const Interrupted&) {
    throw;
  } catch (const std::exception& error) {  // a full disk, or no memory for a copy
    if (std::exchange(warned_, true)) return;
    const Warning warning{fmt::format("{}; the live view stands still, the run goes on", error.what())};
    state_.Add(warning);
    listener_(warning);
  }
}

void SnapshotClock::Took(double end, double cost) { next_ = end + std::max(kMinPause, kPauseOfCost * cost); }

double WriteSnapshot(const std::filesystem::path& path, const Gaussians& gaussians) {
  const Stopwatch watch;
  ReplaceFile(path, EncodeSplat(gaussians.To(kCpu)));
  return watch.Seconds();
}

}  // namespace oraclegs
