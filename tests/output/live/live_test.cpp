#include "oraclegs/output/live/live.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/formats/codecs.h"
#include "oraclegs/gaussians/ply.h"
#include "oraclegs/run/reconstruct.h"
#include "oraclegs/run/start.h"
#include "run/fixtures.h"
#include "support/buffers.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {
using testing::HasSubstr;
namespace fs = std::filesystem;

nlohmann::json StateIn(const fs::path& out) { return nlohmann::json::parse(ReadFile(out / "live" / "state.json")); }

/// A csv without its column of seconds.
std::vector<std::string> WithoutSeconds(const fs::path& csv) {
  std::vector<std::string> rows;
  for (const CurveRow& row : ReadCurves(csv)) {
    rows.push_back(fmt::format("{} {:.9g} {}", row.iteration, row.loss, row.gaussians));
  }
  return rows;
}

class LiveTest : public testing::Test {
 protected:
  ~LiveTest() override { RequestInterrupt(false); }

  TempDir temp;
  RunRequest request = TinyRequest(MakeTinyScene(temp / "scene"), temp / "out");
  EventRecorder recorder;
};

TEST_F(LiveTest, AFinishedRunSaysSo) {
  Reconstruct(request, recorder.AsListener());
  const nlohmann::json state = StateIn(temp / "out");
  EXPECT_EQ(state.at("format"), 1);
  EXPECT_EQ(state.at("state"), "finished");
  EXPECT_FALSE(IsFolderLocked(temp / "out" / "live"));
  bool trained = false;
  for (const auto& stage : state.at("stages")) trained = trained || stage.at("name") == "train";
  EXPECT_TRUE(trained);
  const auto rows = ReadCurves(temp / "out" / "train.csv");
  ASSERT_EQ(rows.size(), 30u);
  EXPECT_EQ(rows.back().iteration, 30);
  EXPECT_EQ(state.at("curves")[0].at("x").size(), 30u);
  EXPECT_GT(rows.back().gaussians, 0);

  Reconstruct(request, recorder.AsListener());  // nothing is done
  EXPECT_EQ(StateIn(temp / "out").at("stages")[0].at("state"), "unchanged");
  EXPECT_EQ(StateIn(temp / "out").at("curves")[0].at("x").size(), 30u);
}

TEST_F(LiveTest, ThereIsASplatFromTheStartOfTraining) {
  bool seen = false;
  const Listener look = [&](const Event& event) {
    const auto* step = std::get_if<StepDone>(&event);
    if (step == nullptr || step->stage != "train") return;
    seen = true;
    EXPECT_TRUE(IsFolderLocked(temp / "out" / "live"));
    const nlohmann::json state = StateIn(temp / "out");
    EXPECT_EQ(state.at("state"), "running");
    EXPECT_EQ(state.at("lock"), true);
    EXPECT_EQ(state.at("splat").at("url"), "live/splat.splat");
    const auto splat = DecodeSplat(ReadFile(temp / "out" / "live" / "splat.splat"), "splat");
    EXPECT_EQ(splat.gaussians.size(), state.at("splat").at("gaussians"));
  };
  auto run = StartRun(request, look);
  RunStage(&run, "train");
  EXPECT_TRUE(seen);
}

TEST_F(LiveTest, TheLastSplatIsTheResult) {
  request.options.input.frame = FrameKind::kScene;  // so that the result is not moved
  {
    auto run = StartRun(request, Silent());
    RunStage(&run, "train");
  }
  const auto ply = ReadGaussianPly(temp / "out" / "point_cloud.ply");
  EXPECT_EQ(ReadFile(temp / "out" / "live" / "splat.splat"), EncodeSplat(ply.gaussians));
}

TEST_F(LiveTest, IsRemovedWhenAReportHasTheSplat) {
  auto run = std::make_unique<oraclegs::Run>(StartRun(request, Silent()));
  RunStage(run.get(), "train");
  WriteText(temp / "out" / "report" / "run.json", R"({"finished": true})");
  run.reset();
  EXPECT_FALSE(fs::exists(temp / "out" / "live" / "splat.splat"));
  EXPECT_TRUE(StateIn(temp / "out").at("splat").is_null());
  EXPECT_EQ(StateIn(temp / "out").at("document"), true);
}

TEST_F(LiveTest, ChangesNoBitOfTheResult) {
  Reconstruct(request, Silent());
  RunRequest blind = request;
  blind.out = temp / "blind";
  auto run = StartRun(blind, Silent());
  run.observer = nullptr;
  run.listener = Silent();
  RunStage(&run, "train");
  EXPECT_EQ(ReadFile(temp / "out" / "point_cloud.ply"), ReadFile(temp / "blind" / "point_cloud.ply"));
}

TEST_F(LiveTest, ScoresTestViewsWithoutChangingABit) {
  Reconstruct(request, Silent());
  RunRequest scored = request;
  scored.out = temp / "scored";
  scored.options.checkpoints.eval_every = 8;
  const nlohmann::json metrics = Reconstruct(scored, Silent());
  EXPECT_EQ(ReadFile(temp / "out" / "point_cloud.ply"), ReadFile(temp / "scored" / "point_cloud.ply"));
  EXPECT_EQ(WithoutSeconds(temp / "out" / "train.csv"), WithoutSeconds(temp / "scored" / "train.csv"));
  std::vector<int64_t> at;
  const auto rows = ReadCurves(temp / "scored" / "train.csv");
  for (const CurveRow& row : rows) {
    if (std::isfinite(row.psnr)) at.push_back(row.iteration);
    EXPECT_GE(row.milliseconds, 0);
    EXPECT_GT(row.l1, 0);
    EXPECT_LT(row.ssim, 1);
    EXPECT_GT(row.regularization, 0);
    EXPECT_TRUE(std::isnan(row.proposal));
  }
  EXPECT_THAT(at, testing::ElementsAre(8, 16, 24, 30));
  EXPECT_NEAR(rows.back().psnr, metrics.at("test").at("psnr").get<double>(), 1e-4);  // of seven digits
  EXPECT_TRUE(std::isnan(ReadCurves(temp / "out" / "train.csv").back().psnr));
}

TEST_F(LiveTest, AnInterruptedRunContinuesItsCurves) {
  request.options.train.iterations = 250;
  RunRequest straight = request;
  straight.out = temp / "straight";
  straight.options.machine.threads = 1;
  Reconstruct(straight, Silent());
  const Listener stop = [](const Event& event) {
    const auto* step = std::get_if<StepDone>(&event);
    if (step && step->stage == "train" && step->done >= 100) RequestInterrupt(true);
  };
  EXPECT_THROW(Reconstruct(request, stop), Interrupted);
  RequestInterrupt(false);
  const nlohmann::json state = StateIn(temp / "out");
  EXPECT_EQ(state.at("state"), "interrupted");
  EXPECT_THAT(state.at("message").get<std::string>(), HasSubstr("interrupted at iteration"));
  {  // as if it had been killed after more iterations than its checkpoint has
    auto rows = ReadCurves(temp / "out" / "train.csv");
    rows.push_back({240, 1, 7, 7});
    ReplaceFile(temp / "out" / "train.csv", CurvesToCsv(rows));
  }
  Reconstruct(request, Silent());
  EXPECT_EQ(WithoutSeconds(temp / "out" / "train.csv"), WithoutSeconds(temp / "straight" / "train.csv"));
  EXPECT_EQ(ReadCurves(temp / "out" / "train.csv").size(), 250u);
}

TEST_F(LiveTest, AFailureIsTheEnd) {
  auto run = StartRun(request, recorder.AsListener());
  EXPECT_THROW(Guarded(run.observer.get(), [] { throw RunError("the disk is full"); }), RunError);
  EXPECT_EQ(StateIn(temp / "out").at("state"), "failed");
  EXPECT_EQ(StateIn(temp / "out").at("message"), "the disk is full");
}

TEST_F(LiveTest, WhatNobodyGuardsFailsToo) {
  try {
    auto run = StartRun(request, recorder.AsListener());
    throw RunError("somewhere else");
  } catch (const RunError&) {
  }
  EXPECT_EQ(StateIn(temp / "out").at("state"), "failed");
}

TEST_F(LiveTest, AFileThatCannotBeWrittenIsOneWarning) {
  const Listener spoil = [&](const Event& event) {
    recorder.AsListener()(event);
    const auto* start = std::get_if<StageStarted>(&event);
    if (start && start->stage == "train") {
      fs::remove_all(temp / "out" / "live");
      fs::create_directories(temp / "out" / "train.csv");  // where a file should go
    }
  };
  const nlohmann::json metrics = Reconstruct(request, spoil);
  EXPECT_EQ(metrics.at("train").at("iterations"), 30);
  int warnings = 0;
  for (const std::string& text : recorder.warnings) warnings += text.find("the live view stands still") != text.npos;
  EXPECT_EQ(warnings, 1);
}

TEST_F(LiveTest, OverwriteRemovesIt) {
  Reconstruct(request, Silent());
  WriteText(temp / "out" / "live" / "splat.splat", "old");
  request.overwrite = true;
  request.options.train.iterations = 5;
  Reconstruct(request, Silent());
  EXPECT_EQ(ReadCurves(temp / "out" / "train.csv").size(), 5u);
  EXPECT_FALSE(fs::exists(temp / "out" / "live" / "splat.splat")) << "the report has the splat";
}

TEST(SnapshotClock, TheFirstIsDueAtOnceAndCheapOnesEveryThreeSeconds) {
  SnapshotClock clock;
  EXPECT_TRUE(clock.IsDue(0));
  clock.Took(0.1, 0.01);
  EXPECT_FALSE(clock.IsDue(3));
  EXPECT_TRUE(clock.IsDue(3.2));
}

TEST(SnapshotClock, DearOnesAreAtMostAFiftieth) {
  SnapshotClock clock;
  clock.Took(10, 2);
  EXPECT_FALSE(clock.IsDue(109));
  EXPECT_TRUE(clock.IsDue(110));
}

TEST(WriteSnapshot, WritesASplat) {
  TempDir dir;
  Gaussians gaussians = Gaussians::Zeros(7);
  Flat(gaussians.quats).setConstant(0.5f);
  gaussians.means[20] = 3;
  EXPECT_GE(WriteSnapshot(dir / "a.splat", gaussians), 0);
  EXPECT_EQ(ReadFile(dir / "a.splat"), EncodeSplat(gaussians));
  EXPECT_THROW(WriteSnapshot(dir / "missing" / "a.splat", gaussians), RunError);
}

class EarlySplatTest : public testing::Test {
 protected:
  TempDir temp;
  EventRecorder recorder;
  oraclegs::Run run = StartRun(TinyRequest(MakeTinyScene(temp / "scene"), temp / "out"), recorder.AsListener());
};

TEST_F(EarlySplatTest, ShowsPointsAsDots) {
  run.results->points.clear();
  for (int i = 0; i < 50; ++i) run.results->points.push_back({Eigen::Vector3d(0.1 * i, 0, 2), {255, 0, 0}, {}});
  run.results->points.push_back({Eigen::Vector3d(900, 0, 2), {0, 255, 0}, {}});
  const EarlySplat sparse = EarlySplatOf(run, "sfm");
  EXPECT_EQ(sparse.of, "sparse points");
  ASSERT_EQ(sparse.gaussians.size(), 51);
  EXPECT_NEAR(std::exp(sparse.gaussians.log_scales[3]), 0.024, 0.012) << "a fifth of the neighbors' distance";
  EXPECT_LT(std::exp(sparse.gaussians.log_scales[150]), 0.3) << "one that is far from all others is no balloon";
  EXPECT_EQ(EarlySplatOf(run, "depth").gaussians.size(), 0) << "no point was found";
}

TEST_F(EarlySplatTest, ThinsMany) {
  DensePoint point{};
  point.rgb = {0.2f, 0.4f, 0.6f}, point.normal = {0, 0, -1};
  for (int i = 0; i < 250000; ++i) {
    point.xyz = {0.01f * static_cast<float>(i), 0, 2};
    run.results->geometry.points.push_back(point);
  }
  const EarlySplat dense = EarlySplatOf(run, "depth");
  EXPECT_EQ(dense.of, "dense points");
  EXPECT_EQ(dense.gaussians.size(), 100000);
}

TEST_F(EarlySplatTest, HasNothingOfOtherStages) {
  for (const char* stage : {"photos", "register", "poses", "proxies", "validate", "train"}) {
    EXPECT_EQ(EarlySplatOf(run, stage).gaussians.size(), 0) << stage;
  }
}

}  // namespace
}  // namespace oraclegs
