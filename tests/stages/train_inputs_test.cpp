#include "oraclegs/stages/train_inputs.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "run/fixtures.h"
#include "support/event_recorder.h"

namespace oraclegs {
namespace {

constexpr int kSide = 24;

/// A gray square in the middle of a white picture, at inverse depth 0.5, of which the left half is confident.
struct Object {
  std::vector<LoadedView> photos;
  Geometry geometry;

  TrainingViews training() const { return TrainingViews(photos); }

  Object() {
    Camera camera{kSide, kSide, 20, 20, kSide / 2., kSide / 2., Eigen::Isometry3d::Identity()};
    LoadedView photo{"a.png", camera, {kSide, kSide, 3, {}}, {}};
    DepthMap map{"a.png", camera, {}, {}, {}};
    for (int i = 0; i < kSide * kSide; ++i) {
      const int x = i % kSide, y = i / kSide;
      const bool object = x >= 8 && x < 16 && y >= 8 && y < 16;
      photo.rgb.data.insert(photo.rgb.data.end(), 3, object ? 0.4f : 1.f);
      map.inv_depth.push_back(object ? 0.5f : 0.f);
      map.normals.emplace_back(0, 0, object ? -1 : 0);
      map.confidence.push_back(!object ? 0 : x < 12 ? 0.9f : 0.3f);
    }
    photos.push_back(std::move(photo));
    geometry.maps.push_back(std::move(map));
    geometry.gains.emplace_back(1.2f, 1.f, 0.8f);
  }
};

TEST(TrainInputs, MaskDepthByConfidenceAndSilhouette) {
  const Object object;
  const TrainView view = MakeTrainViews(object.training(), object.geometry, DepthLoss::kRelative).front();
  const auto depth = [&](int y, int x) { return view.inv_depth[y * kSide + x]; };
  const auto mask = [&](int y, int x) { return view.depth_mask[y * kSide + x]; };
  EXPECT_EQ(depth(10, 9), 0.5f);
  EXPECT_NEAR(mask(10, 9), 0.9, 1e-6);
  EXPECT_EQ(mask(10, 14), 0) << "not confident";
  EXPECT_EQ(depth(2, 2), 0);
  EXPECT_EQ(mask(2, 2), 1) << "empty for certain";
  EXPECT_EQ(mask(10, 7), 0) << "too near the silhouette to be certain";
  EXPECT_FLOAT_EQ(view.exposure[0], 1.2f);
  EXPECT_FLOAT_EQ(view.exposure[10], 0.8f);
  EXPECT_FALSE(MakeTrainViews(object.training(), {}, DepthLoss::kRelative).front().inv_depth.defined());
}

TEST(TrainInputs, WeightANetworksDepthByItsConfidence) {
  Object object;
  object.geometry.maps[0].monocular = true;
  const TrainView view = MakeTrainViews(object.training(), object.geometry, DepthLoss::kRelative).front();
  const auto mask = [&](int y, int x) { return view.depth_mask[y * kSide + x]; };
  EXPECT_NEAR(mask(10, 9), 0.9, 1e-6);
  EXPECT_NEAR(mask(10, 14), 0.3, 1e-6);
}

TEST(TrainInputs, MaskDepthByZeroAndOneForThePaper) {
  Object object;
  const auto masks = [&] {
    const TrainView view = MakeTrainViews(object.training(), object.geometry, DepthLoss::kPaper).front();
    return std::vector<float>{view.depth_mask[10 * kSide + 9], view.depth_mask[10 * kSide + 14],
                              view.depth_mask[2 * kSide + 2]};
  };
  EXPECT_THAT(masks(), testing::ElementsAre(1, 0, 0)) << "confident, not confident, nothing";
  object.geometry.maps[0].monocular = true;
  EXPECT_THAT(masks(), testing::ElementsAre(1, 1, 0)) << "a network's depth counts wherever the silhouette allows";
  object.geometry.maps[0].inv_depth[10 * kSide + 14] = 0, object.geometry.maps[0].confidence[10 * kSide + 14] = 0;
  EXPECT_THAT(masks(), testing::ElementsAre(1, 1, 0)) << "and beyond infinity";
  std::fill(object.geometry.maps[0].confidence.begin(), object.geometry.maps[0].confidence.end(), 0.f);
  EXPECT_THAT(masks(), testing::ElementsAre(0, 0, 0)) << "but not where it could not be aligned";
}

TEST(SettleUnion, DrawsFromOnePile) {
  TrainOptions options;
  options.schedule = ScheduleKind::kUnion;
  const TrainOptions settled = SettleUnion(options, 12, 36);
  EXPECT_EQ(settled.Proposals().floor, 0.75);
  EXPECT_EQ(settled.Proposals().peak, 0);
  EXPECT_EQ(SettleUnion(options, 12, 0).Proposals().floor, 0);
  options.schedule = ScheduleKind::kPaper;
  EXPECT_EQ(SettleUnion(options, 12, 36).Proposals().peak, 1) << "others stay as they are";
}

TEST(TrainInputs, LearnExposureWhereItVaries) {
  EventRecorder recorder;
  Geometry geometry;
  geometry.gains.assign(4, Eigen::Vector3f::Constant(1.01f));
  TrainOptions options;
  EXPECT_EQ(SettleTrainOptions(options, TrainingViews({}), geometry, recorder.AsListener()).exposure,
            ExposureMode::kOff);
  EXPECT_EQ(SettleTrainOptions(options, TrainingViews({}), {}, recorder.AsListener()).exposure, ExposureMode::kOff);
  EXPECT_TRUE(recorder.notes.empty());
  geometry.gains[1] = Eigen::Vector3f::Constant(1.5f);
  EXPECT_EQ(SettleTrainOptions(options, TrainingViews({}), geometry, recorder.AsListener()).exposure,
            ExposureMode::kOn);
  EXPECT_THAT(recorder.notes.back(), testing::HasSubstr("--exposure"));
  options.exposure = ExposureMode::kOff;
  EXPECT_EQ(SettleTrainOptions(options, TrainingViews({}), geometry, recorder.AsListener()).exposure,
            ExposureMode::kOff);
}

TEST(TrainInputs, SettleWhatIsAutomatic) {
  EventRecorder recorder;
  const Object object;
  TrainOptions options = SettleTrainOptions({}, object.training(), object.geometry, recorder.AsListener());
  EXPECT_GT(options.dropout.value(), 0) << "an object";
  EXPECT_THAT(recorder.notes.front(), testing::HasSubstr("silhouettes"));
  EXPECT_GT(options.opacity_noise.value(), 0);
  EXPECT_LT(options.last_rates.value(), 1);
  Object scene;
  for (size_t i = 0; i < scene.photos[0].rgb.data.size(); i += 2) scene.photos[0].rgb.data[i] = 0;  // no plain border
  EXPECT_EQ(SettleTrainOptions({}, scene.training(), scene.geometry, Silent()).dropout, 0.);
  TrainOptions given;
  given.dropout = 0., given.opacity_noise = 0.;
  given.last_rates = 1.;
  given = SettleTrainOptions(given, object.training(), object.geometry, Silent());
  EXPECT_EQ(given.dropout, 0.);
  EXPECT_EQ(given.opacity_noise, 0.);
  EXPECT_EQ(given.last_rates, 1.);
}

TEST(TrainInputs, RaiseTheRatesOfAShortRun) {
  const auto settle = [](TrainOptions options) { return SettleTrainOptions(options, TrainingViews({}), {}, Silent()); };
  TrainOptions options;
  options.iterations = 7500;
  TrainOptions settled = settle(options);
  EXPECT_DOUBLE_EQ(settled.rate_scale.value(), 2);
  EXPECT_EQ(settled.refine_start, kUsualRefineStart);
  EXPECT_EQ(settled.refine_every, kUsualRefineEvery);
  EXPECT_EQ(settled.sh_degree_interval, kUsualShDegreeInterval);
  options.iterations = 2000;
  settled = settle(options);
  EXPECT_EQ(settled.refine_start, 200);
  EXPECT_EQ(settled.refine_every, 40);
  EXPECT_EQ(settled.sh_degree_interval, 400);
  options.iterations = 2;
  settled = settle(options);
  EXPECT_EQ(settled.rate_scale, 6.);
  EXPECT_EQ(settled.refine_every, 10);
  EXPECT_EQ(settled.sh_degree_interval, 1);
  options.iterations = 60000;
  EXPECT_EQ(settle(options).rate_scale, 1.);
  options.iterations = 2000, options.horizon = 30000;  // the course of the paper, stopped early
  EXPECT_EQ(settle(options).rate_scale, 1.);
  options.horizon = 0, options.rate_scale = 1.5, options.refine_every = 7;
  settled = settle(options);
  EXPECT_EQ(settled.rate_scale, 1.5);
  EXPECT_EQ(settled.refine_every, 7);
}

TEST(ChosenOptions, AreThoseThatWereAutomatic) {
  TrainOptions asked, settled;
  asked.iterations = 7500, asked.dropout = 0.1;
  settled = asked;
  settled.rate_scale = 2., settled.dropout = 0.2, settled.exposure = ExposureMode::kOff;
  EXPECT_EQ(ChosenOptions(asked, settled), nlohmann::json({{"rate-scale", 2.0}, {"exposure", "off"}}));
}

TEST(TrainInputs, TakeProposalsOfProxyModelsAsOftenAsTheyAreTrusted) {
  EventRecorder recorder;
  std::vector<TrainView> proposals(2);
  proposals[0].pixel_weight = Buffer<float>::Full({4, 6}, 1.f);
  proposals[1].pixel_weight = Buffer<float>::Full({4, 6}, 0.5f);
  const TrainOptions settled = SettleProxyDose({}, proposals, recorder.AsListener());
  EXPECT_EQ(settled.schedule, ScheduleKind::kConstant);
  EXPECT_NEAR(settled.synthetic_floor.value(), 0.5 * (1 + 0.25) / 2, 1e-12);
  EXPECT_THAT(recorder.notes, testing::ElementsAre("31 % of the iterations take a proposal (--set synthetic-floor)"));
  EXPECT_TRUE(SettleProxyDose({}, {}, Silent()).schedule.is_auto());
  TrainOptions asked;
  asked.synthetic_floor = 0.2;
  EXPECT_TRUE(SettleProxyDose(asked, proposals, Silent()).schedule.is_auto());
  asked = {};
  asked.schedule = ScheduleKind::kPaper;
  EXPECT_TRUE(SettleProxyDose(asked, proposals, Silent()).synthetic_floor.is_auto());
}

TEST(TrainInputs, SaveExposuresByName) {
  const auto json = ExposuresToJson({"a.png"}, {{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}});
  EXPECT_EQ(json.at("a.png").size(), 12u);
  EXPECT_EQ(json.at("a.png").at(7), 7);
}

}  // namespace
}  // namespace oraclegs
