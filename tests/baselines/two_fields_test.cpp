#include "oraclegs/baselines/two_fields.h"
#include "train/gaussian_fixtures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "baselines/baseline_trainer.h"
#include "oraclegs/baselines/adaptive_density.h"
#include "oraclegs/baselines/random_background.h"
#include "support/buffers.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

Gaussians WithCenters(const std::vector<std::array<float, 3>>& centers) {
  Gaussians g = RandomGaussians(static_cast<int64_t>(centers.size()), 1);
  std::copy(&centers[0][0], &centers[0][0] + 3 * centers.size(), g.means.data());
  return g;
}

TEST(CoPruneKeep, KeepsWhatTheOtherModelHas) {
  const Gaussians model = WithCenters({{0, 0, 0}, {5, 0, 0}, {5.001f, 0, 0}, {100, 103, 104}, {100, 103, 105}});
  const Gaussians other = WithCenters({{0, 0, 0}, {100, 100, 100}});
  EXPECT_EQ(CoPruneKeep(model, other, 5), (std::vector<uint8_t>{1, 1, 0, 1, 0}));
  EXPECT_EQ(CoPruneKeep(model, other, 6), (std::vector<uint8_t>{1, 1, 1, 1, 1}));
  EXPECT_EQ(CoPruneKeep(model, other, 0), (std::vector<uint8_t>{1, 0, 0, 0, 0}));
  EXPECT_EQ(CoPruneKeep(other, model, 5), (std::vector<uint8_t>{1, 1}));
}

TEST(CoPruneKeep, AgreesWithEveryPairForAnyNumberOfThreads) {
  const Gaussians a = RandomGaussians(3000, 1), b = RandomGaussians(2000, 2);
  std::vector<uint8_t> expected;
  for (int64_t i = 0; i < a.size(); ++i) {
    const Eigen::RowVector3d center = Table(a.means).row(i).matrix().cast<double>();
    const auto others = Table(b.means).matrix().cast<double>();
    expected.push_back((others.rowwise() - center).rowwise().norm().minCoeff() <= 0.3);
  }
  for (const int threads : {1, 3}) {
    const Threads scope(threads);
    EXPECT_EQ(CoPruneKeep(a, b, 0.3), expected);
  }
  EXPECT_GT(std::count(expected.begin(), expected.end(), 0), 100);
  EXPECT_GT(std::count(expected.begin(), expected.end(), 1), 100);
}

TEST(CoPruneKeep, TakesEmptyModels) {
  const Gaussians none = Gaussians::Empty(0), some = RandomGaussians(3, 1);
  EXPECT_TRUE(CoPruneKeep(none, some, 5).empty());
  EXPECT_EQ(CoPruneKeep(some, none, 5), (std::vector<uint8_t>{0, 0, 0}));
}

BaselineSetup SetupOf(int iterations, int co_start) {
  TrainOptions options = Options(iterations);
  options.opacity_reg = options.scale_reg = options.largest_scale = 0;
  options.max_gaussians = 300;
  BaselineSetup setup = SmallSetup(options, Photos(3));
  setup.baseline.adaptive = true;
  setup.baseline.opacity_reset = 0;
  setup.baseline.two_fields = true;
  setup.baseline.co_start = co_start;
  setup.densifier = AdaptiveDensifierMaker(setup.baseline, setup.background);
  return setup;
}

struct Pair {
  Gaussians first, second;
};

Pair Train(BaselineSetup setup) {
  const auto fields = std::make_shared<TwoFields>(setup);
  setup.parts = {fields};
  if (setup.baseline.random_background) setup.parts.push_back(std::make_shared<RandomBackgrounds>(setup.seed));
  Trainer trainer(std::move(setup), OnTheCpu);
  trainer.Run({}, Silent());
  return {trainer.gaussians().Clone(), fields->second().Clone()};
}

/// Difference between the renders of both models halfway between two photos.
double Disagreement(const Pair& pair) {
  auto rasterizer = MakeRasterizer(kCpu);
  const Camera camera = CameraOnCircle(0.15);
  const Buffer<float> a = rasterizer->Forward(pair.first, camera, {}, RenderPass::kInference).image.Clone();
  const Buffer<float> b = rasterizer->Forward(pair.second, camera, {}, RenderPass::kInference).image;
  return (Wide(a) - Wide(b)).abs().mean();
}

TEST(TwoFields, LeaveTheFirstModelAloneUntilTheyAreToAgree) {
  BaselineSetup alone = SetupOf(60, 1000);
  Trainer trainer(std::move(alone), OnTheCpu);
  trainer.Run({}, Silent());
  const Pair pair = Train(SetupOf(60, 1000));
  EXPECT_TRUE(SameBits(pair.first, trainer.gaussians()));
  EXPECT_NE(pair.second.size(), 0);
  EXPECT_FALSE(SameBits(pair.first, pair.second)) << "halves of what is split are drawn anew";
}

TEST(TwoFields, AgreeMoreWhereTheyArePulledTogether) {
  const double apart = Disagreement(Train(SetupOf(150, 1000))), together = Disagreement(Train(SetupOf(150, 1)));
  EXPECT_GT(apart, 0);
  EXPECT_LT(together, 0.8 * apart);
}

TEST(TwoFields, AreTheSameForAnyNumberOfThreads) {
  const Pair pair = Train(SetupOf(80, 40));
  const Threads scope(3);
  const Pair again = Train(SetupOf(80, 40));
  EXPECT_TRUE(SameBits(pair.first, again.first));
  EXPECT_TRUE(SameBits(pair.second, again.second));
}

TEST(TwoFields, GoOnFromACheckpointToTheSameBits) {
  const Pair whole = Train(SetupOf(90, 40));
  const auto begin = [](std::shared_ptr<TwoFields>* fields) {
    BaselineSetup setup = SetupOf(90, 40);
    *fields = std::make_shared<TwoFields>(setup);
    setup.parts = {*fields};
    return std::make_unique<Trainer>(std::move(setup), OnTheCpu);
  };
  std::shared_ptr<TwoFields> first_fields, fields;
  const TempDir dir;
  const auto stopped = begin(&first_fields);
  for (int i = 0; i < 45; ++i) stopped->Step();
  WriteCheckpoint(dir / "c", stopped->MakeCheckpoint());
  const auto resumed = begin(&fields);
  resumed->Restore(ReadCheckpoint(dir / "c"));
  resumed->Run({}, Silent());
  EXPECT_TRUE(SameBits(resumed->gaussians(), whole.first));
  EXPECT_TRUE(SameBits(fields->second(), whole.second));

  Checkpoint of_one = stopped->MakeCheckpoint();
  of_one.state.models.clear();
  EXPECT_THAT(MessageOf<InputError>([&] { resumed->Restore(of_one); }), testing::HasSubstr("holds no model 'second'"));
}

TEST(TwoFields, KeepTheBackgroundOfPhotosWithTransparency) {
  const auto train = [](bool random, bool has_alpha) {
    BaselineSetup setup = SetupOf(60, 20);
    setup.baseline.random_background = random;
    for (TrainView& photo : setup.data.photos) {
      if (!has_alpha) continue;
      photo.alpha = Buffer<float>::Zeros({photo.image.size(0), photo.image.size(1)});
      std::fill(photo.alpha.span().begin(), photo.alpha.span().end(), 1.f);
    }
    return Train(std::move(setup)).first;
  };
  EXPECT_TRUE(SameBits(train(true, true), train(false, true)));
  EXPECT_FALSE(SameBits(train(true, false), train(false, false)));
}

TEST(TwoFields, RemoveWhatOnlyOneHas) {
  BaselineSetup setup = SetupOf(600, 1000);
  setup.baseline.co_prune_distance = 0.02;
  TwoFields fields(setup);
  const int64_t n = setup.start.size();
  TrainedModel model{setup.start.Clone(), Adam(n)};
  PartGradients grads;
  fields.BeforeView({}, &model, &grads);                                      // the second model stands near the start
  for (int64_t i = 0; i < 3; ++i) model.gaussians.means[3 * (7 + i)] += 100;  // which leaves three of it alone
  const Buffer<float> next = model.gaussians.means.Rows(10, 11).Clone();
  int64_t isolated = 0;
  for (const uint8_t keep : CoPruneKeep(fields.second(), model.gaussians, 0.02)) isolated += keep == 0 ? 1 : 0;
  EXPECT_GT(isolated, 0);
  Iteration iteration;
  for (const int64_t other : {500, 511}) {
    iteration.number = other;
    fields.Remove(iteration, &model);
    EXPECT_EQ(model.gaussians.size(), n) << "only after every 500 iterations";
  }
  iteration.number = 501;
  fields.Remove(iteration, &model);
  EXPECT_EQ(model.gaussians.size(), n - 3);
  EXPECT_EQ(model.adam.m.size(), n - 3);
  EXPECT_TRUE(Equal(model.gaussians.means.Rows(7, 8), next));
  EXPECT_EQ(fields.second().size(), n - isolated) << "both are compared before either loses anything";
  EXPECT_NO_THROW(fields.BeforeView(iteration, &model, &grads)) << "the second model goes on";
}

}  // namespace

}  // namespace oraclegs
