#include "oraclegs/settings/from_results.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/event_recorder.h"

namespace oraclegs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(SettleSfmPoints, TakesTheModelsWhereAllViewsTrain) {
  StartOptions asked;
  EXPECT_EQ(SettleSfmPoints(asked, true), SfmPoints::kModel);
  EXPECT_EQ(SettleSfmPoints(asked, false), SfmPoints::kTriangulate);
  asked.sfm_points = SfmPoints::kModel;
  EXPECT_EQ(SettleSfmPoints(asked, false), SfmPoints::kModel);
}

TEST(SettleTargets, AsksProxyModelsForMore) {
  TrajectoryOptions asked;
  EXPECT_EQ(SettleTargets(asked, true, {12, 1}).count, 96);
  const TargetPlan usual = SettleTargets(asked, false, {12, 1});
  EXPECT_EQ(usual.count, 32);
  EXPECT_EQ(usual.trajectory, Trajectory::kDataset);
  EXPECT_TRUE(usual.or_coverage);
  EXPECT_EQ(SettleTargets(asked, true, {6, 0.9 * kMinOpenness}).count, 0) << "nothing is open";
  EXPECT_EQ(SettleTargets(asked, true, {5, 0.9 * kMinOpenness}).count, 96) << "few photos always leave something open";
  asked.proposals = 5, asked.trajectory = Trajectory::kDataset;
  EXPECT_EQ(SettleTargets(asked, true, {12, 1}).count, 5);
  EXPECT_EQ(SettleTargets(asked, true, {12, 0}).count, 5);
  EXPECT_FALSE(SettleTargets(asked, true, {12, 1}).or_coverage) << "asked for, however few there are";
}

TEST(SettleProxyFinish, IsLongerForAnObject) {
  ProposeOptions asked;
  EXPECT_EQ(SettleProxyFinish(asked, false), 0.4);
  EXPECT_EQ(SettleProxyFinish(asked, true), 0.6);
  asked.proxy_finish = 0.1;
  EXPECT_EQ(SettleProxyFinish(asked, true), 0.1);
}

TEST(SettleStart, TakesTheBestPointsThereAre) {
  EventRecorder recorder;
  const auto start = [&](const StartCounts& found) { return SettleStart({}, found, recorder.AsListener()); };
  EXPECT_THAT(start({1000, 0, 500, true}), ElementsAre(StartKind::kDense));
  EXPECT_THAT(recorder.warnings, IsEmpty());
  EXPECT_THAT(start({999, 1000, 5000, true}), ElementsAre(StartKind::kSfm));
  EXPECT_THAT(recorder.warnings, ElementsAre(HasSubstr("stereo gave 999 points only")));
  recorder.warnings.clear();
  EXPECT_THAT(start({0, 999, 5000, false}), ElementsAre(StartKind::kSfm, StartKind::kRandom));
  EXPECT_THAT(start({0, 600, 500, false}), ElementsAre(StartKind::kSfm)) << "there is no room for more";
  EXPECT_THAT(recorder.warnings, IsEmpty()) << "nobody looked for dense points";
  EXPECT_THAT(start({0, 99, 5000, false}), ElementsAre(StartKind::kRandom));
  EXPECT_THAT(recorder.warnings, ElementsAre(HasSubstr("gave 99 points, fewer than 100")));
  StartOptions asked;
  asked.init = StartKind::kHybrid;
  EXPECT_THAT(SettleStart(asked, {}, recorder.AsListener()), ElementsAre(StartKind::kHybrid));
}

TEST(SettleStartScale, IsSmallerBetweenSparsePoints) {
  StartOptions asked;
  EXPECT_EQ(SettleStartScale(asked, true), 1);
  EXPECT_EQ(SettleStartScale(asked, false), 0.1);
  asked.init_scale = 0.3;
  EXPECT_EQ(SettleStartScale(asked, true), 0.3);
}

TEST(SettleTraining, DrawsAUnionFromOnePile) {
  AutoTrainOptions asked;
  asked.schedule = ScheduleKind::kUnion;
  const auto proposals = [&](size_t count) {
    return SettleTraining(asked, {.photos = 12, .proposals = count}, Silent()).Proposals();
  };
  EXPECT_EQ(proposals(36).floor, 0.75);
  EXPECT_EQ(proposals(36).peak, 0);
  EXPECT_EQ(proposals(0).floor, 0);
  asked.schedule = ScheduleKind::kPaper;
  EXPECT_EQ(proposals(36).peak, 1) << "others stay as they are";
}

TEST(SettleTraining, LearnsExposureWhereItVaries) {
  EventRecorder recorder;
  AutoTrainOptions asked;
  EXPECT_EQ(SettleTraining(asked, {}, recorder.AsListener()).exposure, ExposureMode::kOff);
  EXPECT_THAT(recorder.notes, IsEmpty());
  EXPECT_EQ(SettleTraining(asked, {.exposure_spread = 0.3}, recorder.AsListener()).exposure, ExposureMode::kOn);
  EXPECT_THAT(recorder.notes, ElementsAre(testing::AllOf(HasSubstr("differ by 30 %"), HasSubstr("--exposure"))));
  asked.exposure = ExposureMode::kOff;
  EXPECT_EQ(SettleTraining(asked, {.exposure_spread = 0.3}, recorder.AsListener()).exposure, ExposureMode::kOff);
  asked.exposure = ExposureMode::kOn;
  EXPECT_EQ(SettleTraining(asked, {}, recorder.AsListener()).exposure, ExposureMode::kOn);
  EXPECT_EQ(recorder.notes.size(), 1u) << "what was asked for is no news";
}

TEST(SettleTraining, TreatsAnObjectInItsOwnWay) {
  EventRecorder recorder;
  const TrainOptions object = SettleTraining({}, {.is_object = true}, recorder.AsListener());
  EXPECT_THAT(recorder.notes, ElementsAre(HasSubstr("silhouettes")));
  const TrainOptions scene = SettleTraining({}, {}, Silent());
  EXPECT_GT(object.dropout, 0);
  EXPECT_EQ(scene.dropout, 0);
  EXPECT_LT(object.opacity_noise, scene.opacity_noise);
  EXPECT_LT(scene.last_rates, 1);
  AutoTrainOptions asked;
  asked.dropout = 0., asked.opacity_noise = 0., asked.last_rates = 1., asked.depth_weight = 0.25;
  const TrainOptions given = SettleTraining(asked, {.is_object = true}, Silent());
  EXPECT_EQ(given.dropout, 0);
  EXPECT_EQ(given.opacity_noise, 0);
  EXPECT_EQ(given.last_rates, 1);
  EXPECT_EQ(given.depth_weight, 0.25);
}

TEST(SettleTraining, RaisesTheRatesOfAShortRun) {
  AutoTrainOptions asked;
  const auto settle = [&] { return SettleTraining(asked, {}, Silent()); };
  asked.iterations = 7500, asked.max_gaussians = 123;
  TrainOptions settled = settle();
  EXPECT_EQ(settled.iterations, 7500);
  EXPECT_EQ(settled.max_gaussians, 123);
  EXPECT_DOUBLE_EQ(settled.rate_scale, 2);
  EXPECT_EQ(settled.refine_start, 500);
  EXPECT_EQ(settled.refine_every, 100);
  EXPECT_EQ(settled.sh_degree_interval, 1000);
  asked.iterations = 2000;
  settled = settle();
  EXPECT_EQ(settled.refine_start, 200);
  EXPECT_EQ(settled.refine_every, 40);
  EXPECT_EQ(settled.sh_degree_interval, 400);
  asked.iterations = 2;
  settled = settle();
  EXPECT_EQ(settled.rate_scale, 6);
  EXPECT_EQ(settled.refine_every, 10);
  EXPECT_EQ(settled.sh_degree_interval, 1);
  asked.iterations = 60000;
  EXPECT_EQ(settle().rate_scale, 1);
  asked.iterations = 2000, asked.horizon = 30000;  // the course of the paper, stopped early
  EXPECT_EQ(settle().rate_scale, 1);
  asked.horizon = 0, asked.rate_scale = 1.5, asked.refine_every = 7;
  settled = settle();
  EXPECT_EQ(settled.rate_scale, 1.5);
  EXPECT_EQ(settled.refine_every, 7);
}

TEST(SettleTraining, TakesProposalsOfProxyModelsAsOftenAsTheyAreTrusted) {
  EventRecorder recorder;
  const TrainEvidence found{.photos = 12, .proposals = 2, .proxy_trust = 0.625};
  AutoTrainOptions asked;
  const TrainOptions settled = SettleTraining(asked, found, recorder.AsListener());
  EXPECT_EQ(settled.schedule, ScheduleKind::kFalling);
  EXPECT_EQ(settled.synthetic_floor, 0.5 * 0.625);
  EXPECT_THAT(recorder.notes,
              ElementsAre("31 % of the iterations take a proposal, later ones fewer (--set synthetic-floor)"));
  EXPECT_EQ(SettleTraining(asked, {}, Silent()).schedule, ScheduleKind::kPaper);
  asked.synthetic_floor = 0.2;
  EXPECT_EQ(SettleTraining(asked, found, Silent()).schedule, ScheduleKind::kPaper);
  EXPECT_EQ(SettleTraining(asked, found, Silent()).synthetic_floor, 0.2);
  asked = {};
  asked.schedule = ScheduleKind::kPaper;
  EXPECT_EQ(SettleTraining(asked, found, Silent()).synthetic_floor, 0.1);
}

TEST(ChosenOptions, AreThoseThatWereAutomatic) {
  AutoTrainOptions asked;
  const nlohmann::json all = ChosenOptions(asked, SettleTraining(asked, {}, Silent()));
  EXPECT_EQ(all.size(), 12u);
  EXPECT_EQ(all.at("schedule"), "paper");
  asked.iterations = 7500, asked.dropout = 0.1;
  const nlohmann::json others = ChosenOptions(asked, SettleTraining(asked, {}, Silent()));
  EXPECT_EQ(others.size(), 10u);
  EXPECT_EQ(others.at("rate-scale"), 2.0);
  EXPECT_EQ(others.at("exposure"), "off");
  EXPECT_FALSE(others.contains("dropout"));
}

}  // namespace
}  // namespace oraclegs
