#include "oraclegs/train/exposure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "support/buffers.h"
#include "support/temp_dir.h"
#include "train/small_scene.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

ExposureMap Gain(float gain) { return {gain, 0, 0, 0, 0, gain, 0, 0, 0, 0, gain, 0}; }

ExposureMap RandomMap(uint64_t seed) {
  ExposureMap map = kIdentityExposure;
  const Buffer<float> offset = RandomNormal({12}, seed);
  for (int k = 0; k < 12; ++k) map[k] += 0.2f * offset[k];
  return map;
}

Buffer<float> Applied(const Exposures& exposures, int view, const Buffer<float>& image) {
  const Buffer<float> shown = Buffer<float>::Empty(image.shape());
  exposures.Apply(view, image, shown);
  return shown;
}

Camera Beside(double x) {
  Camera camera{10, 10, 10, 10, 5, 5};
  camera.cam_from_world.translation() = Eigen::Vector3d(-x, 0, 4);
  return camera;
}

TEST(ExposureAt, IsThatOfThePhotosNearBy) {
  const std::vector<Camera> photos = {Beside(0), Beside(1), Beside(2), Beside(9)};
  const std::vector<ExposureMap> maps = {Gain(1), Gain(1.2f), Gain(0.8f), Gain(0.1f)};
  EXPECT_EQ(ExposureAt(photos[1], photos, maps), maps[1]) << "its own";
  EXPECT_NEAR(ExposureAt(Beside(0.5), photos, maps)[0], 1.1, 1e-3) << "as far from both, thrice as far from the next";
  EXPECT_NEAR(ExposureAt(Beside(1.5), photos, maps)[0], 1.0, 1e-3);
  EXPECT_NEAR(ExposureAt(Beside(0.9), photos, maps)[0], 1.0966, 1e-3);  // weights exp(-1), exp(-1/81), exp(-121/81)
}

TEST(ExposureAt, CountsTheTurn) {
  std::vector<Camera> photos = {Beside(0), Beside(0)};
  photos[1].cam_from_world.linear() = Eigen::AngleAxisd(1, Eigen::Vector3d::UnitY()).toRotationMatrix();
  Camera turned = photos[0];
  turned.cam_from_world.linear() = Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitY()).toRotationMatrix();
  EXPECT_NEAR(ExposureAt(turned, photos, {Gain(1), Gain(2)})[0], 1.27, 0.02);  // weights 1 and 1 / e
}

TEST(ExposureAt, OfOnePhotoIsItsOwn) {
  EXPECT_EQ(ExposureAt(Beside(3), {Beside(0)}, {Gain(2)}), Gain(2));
  EXPECT_THROW(ExposureAt(Beside(3), {}, {}), ShapeError);
  EXPECT_THROW(ExposureAt(Beside(3), {Beside(0)}, {}), ShapeError);
}

TEST(ShowThrough, IsTheMapOfEachPixel) {
  const Buffer<float> image = RandomUniform({5, 4, 3}, 7), before = image.Clone();
  ShowThrough({2, 0, 0, 0.5f, 0, 1, 0, 0, 0, 0, 1, 0}, image);
  for (int64_t i = 0; i < image.count(); i += 3) {
    EXPECT_FLOAT_EQ(image[i], 2 * before[i] + 0.5f);
    EXPECT_FLOAT_EQ(image[i + 1], before[i + 1]);
  }
}

TEST(ExposuresTest, TheIdentityChangesNoBit) {
  const Buffer<float> image = RandomUniform({31, 17, 3}, 102);
  const Exposures exposures({kIdentityExposure, kIdentityExposure});
  EXPECT_EQ(exposures.maps()[1], kIdentityExposure);
  EXPECT_TRUE(Equal(Applied(exposures, 1, image), image));
}

TEST(ExposuresTest, GradientsMatchCentralDifferences) {
  const std::vector<ExposureMap> maps = {RandomMap(1), RandomMap(2), RandomMap(3)};
  Exposures exposures(maps);
  Buffer<float> image = RandomUniform({8, 7, 3}, 103), upstream = RandomNormal({8, 7, 3}, 108);
  Buffer<float> grad = upstream.Clone();
  const ExposureGradient by_map = exposures.Backward(1, image, grad);

  // In double, as a function of the map that the gauge has left.
  const Eigen::ArrayXd pixels = Wide(image), weights = Wide(upstream);
  const auto loss = [&](const Eigen::ArrayXd& map, const Eigen::ArrayXd& x) {
    double sum = 0;
    for (int64_t i = 0; i < x.size(); ++i) {
      const auto row = map.segment(4 * (i % 3), 4);
      const auto color = x.segment(i / 3 * 3, 3);
      sum += ((row.head(3) * color).sum() + row[3]) * weights[i];
    }
    return sum;
  };
  const Eigen::ArrayXd map = Eigen::Map<const Eigen::ArrayXf>(exposures.maps()[1].data(), 12).cast<double>();
  const double step = 1e-3;  // the loss is linear in both: any step does
  const auto moved = [&](Eigen::ArrayXd values, int k, double by) {
    values[k] += by;
    return values;
  };
  for (int k = 0; k < 12; ++k) {
    const double up = loss(moved(map, k, step), pixels), down = loss(moved(map, k, -step), pixels);
    EXPECT_NEAR(by_map[k], (up - down) / (2 * step), 1e-4) << k;
  }
  for (int k = 0; k < 168; k += 5) {
    const double up = loss(map, moved(pixels, k, step)), down = loss(map, moved(pixels, k, -step));
    EXPECT_NEAR(grad[k], (up - down) / (2 * step), 1e-5) << k;
  }
}

TEST(ExposuresTest, PullIsTowardsTheIdentity) {
  Exposures exposures({Gain(1.2f), Gain(0.8f)});
  ExposureGradient gradient{};
  gradient[1] = 5;
  EXPECT_NEAR(exposures.AddRegularizer(0, kExposureRegularizer, &gradient), kExposureRegularizer / 2 * 3 * 0.04, 1e-8);
  EXPECT_NEAR(gradient[0], kExposureRegularizer * 0.2, 1e-8);
  EXPECT_EQ(gradient[1], 5);
}

TEST(ExposuresTest, TheGaugeKeepsRatiosAndTheMeanAtTheIdentity) {
  // Gains relative to the first photo: the mean is not 1.
  Exposures exposures({Gain(1), Gain(1.5f), Gain(3)});
  EXPECT_NEAR(exposures.maps()[1][0] / exposures.maps()[0][0], 1.5, 1e-5);
  EXPECT_NEAR(exposures.maps()[2][5] / exposures.maps()[0][5], 3, 1e-5);
  const std::vector<ExposureMap> maps = {RandomMap(4), RandomMap(5), RandomMap(6), RandomMap(7)};
  Exposures mixed(maps);
  const Buffer<float> draws = RandomNormal({20 * 12}, 3);
  int64_t draw = 0;
  for (int i = 0; i < 20; ++i) {
    ExposureGradient gradient;
    for (double& g : gradient) g = draws[draw++];
    mixed.Step(i % 3, gradient, 0.01);
    ExposureGradient mean{};
    for (const ExposureMap& map : mixed.maps()) {
      for (int k = 0; k < 12; ++k) mean[k] += static_cast<double>(map[k]) / 4;
    }
    for (int k = 0; k < 12; ++k) EXPECT_NEAR(mean[k], static_cast<double>(kIdentityExposure[k]), 1e-6);
  }
  // Where the images of two maps meet does not depend on the gauge: shown0 = T(shown1) with T = map0 map1^-1.
  const auto affine = [](const ExposureMap& map) {
    Eigen::Matrix4d t = Eigen::Matrix4d::Identity();
    for (int k = 0; k < 12; ++k) t(k / 4, k % 4) = static_cast<double>(map[k]);
    return t;
  };
  const Exposures fixed(maps);
  const Eigen::Matrix4d of_fixed = affine(fixed.maps()[0]) * affine(fixed.maps()[1]).inverse();
  EXPECT_LE((of_fixed - affine(maps[0]) * affine(maps[1]).inverse()).cwiseAbs().maxCoeff(), 1e-5);
}

TEST(ExposuresTest, SameBitsForAnyNumberOfThreads) {
  const Buffer<float> image = RandomUniform({211, 173, 3}, 104), upstream = RandomNormal({211, 173, 3}, 110);
  const auto run = [&](int threads) {
    const Threads scope(threads);
    Exposures exposures({Gain(1.1f), Gain(0.9f)});
    return exposures.Backward(0, image, upstream.Clone());
  };
  EXPECT_EQ(run(1), run(4));
}

TEST(ExposuresTest, RefusesMapsThatAreNone) {
  EXPECT_THROW(Exposures({}), ShapeError);
  EXPECT_THROW(Exposures({Gain(std::nanf(""))}), ShapeError);
  EXPECT_THROW(Exposures({Gain(0), Gain(0)}), ShapeError);
  Exposures exposures({Gain(1), Gain(1)});
  EXPECT_THROW(exposures.Restore(Exposures({Gain(1)}).state()), InputError);
  EXPECT_THROW(exposures.Apply(0, RandomUniform({4, 4, 3}, 105), RandomUniform({4, 3, 3}, 106)), ShapeError);
}

/// Photos of one scene, taken with other exposures.
std::vector<TrainView> Exposed(const std::vector<float>& gains) {
  auto views = Photos(static_cast<int>(gains.size()));
  for (size_t i = 0; i < gains.size(); ++i) Flat(views[i].image) *= gains[i];
  return views;
}

TrainOptions WithExposure(int iterations) {
  TrainOptions options = Options(iterations);
  options.exposure = ExposureMode::kOn;
  options.opacity_reg = options.scale_reg = 0;
  options.refine_start = iterations;
  return options;
}

TEST(TrainerExposureTest, FindsTheGainBetweenPhotos) {
  Trainer trainer(WithExposure(300), kSeed, {0, 0, 0}, Exposed({1.2f, 0.8f, 1.2f, 0.8f}), Truth());
  const double first = trainer.Step();
  for (int i = 2; i < 300; ++i) trainer.Step();
  EXPECT_LT(trainer.Step(), 0.2 * first);
  const std::vector<ExposureMap> maps = trainer.exposures();
  ASSERT_EQ(maps.size(), 4u);
  // What a map does to a gray of the scene.
  const auto shown = [&](size_t view, int channel) {
    const float* row = maps[view].data() + 4 * channel;
    return 0.5f * (row[0] + row[1] + row[2]) + row[3];
  };
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR((shown(0, c) + shown(2, c)) / (shown(1, c) + shown(3, c)), 1.5, 0.06) << c;
  }
}

TEST(TrainerExposureTest, StartsFromTheMapsThatAreGiven) {
  auto views = Exposed({1.2f, 0.8f});
  views[0].exposure = Gain(3);  // the same ratio in another gauge
  views[1].exposure = Gain(2);
  Trainer given(WithExposure(10), kSeed, {0, 0, 0}, views, Truth());
  EXPECT_NEAR(given.Step(), kExposureRegularizer / 2 * 3 * 0.04, 1e-4);
  EXPECT_NEAR(given.exposures()[0][0], 1.2, 0.02);
}

TEST(TrainerExposureTest, OffIsAsIfItWereNotThere) {
  auto views = Exposed({1.2f, 0.8f});
  const auto run = [&] {
    Trainer trainer(Options(60), kSeed, {0, 0, 0}, views, Start());
    trainer.Run({}, Silent());
    EXPECT_TRUE(trainer.exposures().empty());
    return trainer.gaussians().Clone();
  };
  const Gaussians plain = run();
  views[0].exposure = Gain(3);
  EXPECT_TRUE(SameBits(run(), plain));
}

TEST(TrainerExposureTest, MaskedPixelsContributeNothing) {
  const auto run = [&](float hidden) {
    auto views = Exposed({1.2f, 0.8f, 1.f});
    for (TrainView& view : views) {
      view.pixel_weight = Buffer<float>::Full({kHeight, kWidth}, 1.f);
      Table(view.pixel_weight).rightCols(kWidth - 20).setZero();
      Table(view.image).rightCols(3 * (kWidth - 20)).setConstant(hidden);
    }
    TrainOptions options = WithExposure(60);
    options.ssim_weight = 0;  // its windows reach across the mask, where they find the same photo on both sides
    Trainer trainer(options, kSeed, {0, 0, 0}, views, Start());
    trainer.Run({}, Silent());
    return trainer.exposures();
  };
  EXPECT_EQ(run(0.1f), run(0.9f));
  // All hidden: only the gauge and the pull are left, which do nothing at the identity.
  auto views = Exposed({1.2f, 0.8f});
  for (TrainView& view : views) view.pixel_weight = Buffer<float>::Zeros({kHeight, kWidth});
  Trainer blind(WithExposure(30), kSeed, {0, 0, 0}, views, Start());
  blind.Run({}, Silent());
  EXPECT_EQ(blind.exposures()[0], blind.exposures()[1]);
  EXPECT_EQ(blind.exposures()[0][0], 1);
}

TEST(TrainerExposureTest, ResumingGivesTheBitsOfAnUninterruptedRun) {
  TempDir dir;
  const auto make = [] { return Trainer(WithExposure(60), kSeed, {0, 0, 0}, Exposed({1.2f, 0.8f, 1.f}), Start()); };
  Trainer whole = make();
  whole.Run({dir.path(), 25, {}}, Silent());
  Trainer resumed = make();
  resumed.Restore(ReadCheckpoint(CheckpointPath(dir.path(), 25)));
  resumed.Run({}, Silent());
  EXPECT_TRUE(SameBits(resumed.gaussians(), whole.gaussians()));
  EXPECT_EQ(resumed.exposures(), whole.exposures());
  const std::vector<ExposureMap> maps = whole.exposures();
  float difference = 0;
  for (int k = 0; k < 12; ++k) difference = std::max(difference, std::abs(maps[0][k] - maps[1][k]));
  EXPECT_GT(difference, 0.05f);
}

TEST(TrainerExposureTest, RefusesACheckpointOfOtherPhotos) {
  Trainer three(WithExposure(60), kSeed, {0, 0, 0}, Exposed({1.2f, 0.8f, 1.f}), Start());
  Trainer two(WithExposure(60), kSeed, {0, 0, 0}, Exposed({1.2f, 0.8f}), Start());
  Checkpoint checkpoint = three.MakeCheckpoint();
  checkpoint.sampler = two.MakeCheckpoint().sampler;  // which is refused first
  try {
    two.Restore(checkpoint);
    ADD_FAILURE() << "maps of another number of photos were accepted";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("exposure maps of 3 photos, this run has 2"));
  }
  Trainer without(Options(60), kSeed, {0, 0, 0}, Photos(2), Start());
  EXPECT_THROW(two.Restore(without.MakeCheckpoint()), InputError);
}

}  // namespace
}  // namespace oraclegs
