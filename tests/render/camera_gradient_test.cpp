// The gradient of the camera against differences in double precision, and the promises of its sums.

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <array>

#include "oraclegs/core/parallel.h"
#include "oraclegs/render/color_math-inl.h"
#include "render/camera_numbers.h"
#include "render/reference_raster.h"

namespace oraclegs {
namespace {

namespace math = HWY_NAMESPACE;

/// One Gaussian in double precision, and dL/d(its projection).
struct OneGaussian {
  math::RawSplat<double> raw;
  double sh[kShFloats];
  math::ProjectedGrad<double> up;
  math::Vec3<double> up_color;

  double Get(int k, int c) const { return sh[3 * k + c]; }

  explicit OneGaussian(Rng* rng) {
    const auto draw = [rng] { return rng->Uniform(-1, 1); };
    const double z = rng->Uniform(1, 5);
    raw = {{draw() * z, draw() * z, z}, {draw() - 2, draw() - 2, draw() - 2}, draw(), draw(), draw(), draw(), draw()};
    for (int k = 0; k < kShFloats; ++k) sh[k] = draw();
    up = {draw(), draw(), 9 * draw(), 9 * draw(), 9 * draw(), draw(), draw()};
    up_color = {draw(), draw(), draw()};
  }

  double Loss(const SplatCamera<double>& camera) const {
    const math::ProjectedSplat<double> p = math::Project(math::EvaluateChain(raw, camera), camera);
    double basis[math::kMaxShTerms], inv_distance;
    math::ShBasis(3, math::ViewDirection(raw.mean, camera, &inv_distance), basis);
    const math::Vec3<double> color = math::RawColor(*this, basis, math::kMaxShTerms);
    return up.mx * p.mx + up.my * p.my + up.conic_a * p.conic_a + up.conic_b * p.conic_b + up.conic_c * p.conic_c +
           up.opacity * p.opacity + up.inv_z / p.z + up_color.x * std::max(color.x, 0.0) +
           up_color.y * std::max(color.y, 0.0) + up_color.z * std::max(color.z, 0.0);
  }

  /// As CameraNumbers orders them.
  CameraNumbers Gradient(const SplatCamera<double>& camera) const {
    const auto chain = math::EvaluateChain(raw, camera);
    const auto space = math::ProjectBackward(chain, camera, up);
    const math::Vec3<double> mean = math::RawBackward(chain, camera, space).mean;
    const math::Vec3<double> color =
        math::ColorBackward(camera, raw.mean, *this, up_color, [](const double*, const math::Vec3<double>&) {});
    const math::Vec3<double> of_mean{mean.x + color.x, mean.y + color.y, mean.z + color.z};
    const math::CameraTerms<double> terms = math::CameraBackward(chain, camera, up, space, of_mean);
    CameraNumbers out;
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> rotation(camera.r);
    Eigen::Map<Eigen::Vector3d>(out.data()) = rotation * Eigen::Map<const Eigen::Vector3d>(terms.of);
    std::copy(terms.of + 3, terms.of + kCameraSums, out.begin() + 3);
    return out;
  }
};

class CameraGradientOfOne : public testing::TestWithParam<bool> {};

TEST_P(CameraGradientOfOne, MatchesCentralDifferences) {
  const Camera camera = PosedCamera(60, 50);
  const RenderOptions options{{}, 3, GetParam()};
  const SplatCamera<double> splat_camera = MakeSplatCamera<double>(camera, options);
  Rng rng(5, RandomStream::kInitialPoints);
  int clamped = 0;
  for (int i = 0; i < 200; ++i) {
    OneGaussian one(&rng);
    // As seen from the camera it lies in front, from the middle of the image to far outside.
    const Eigen::Vector3d mean =
        camera.cam_from_world.inverse() * Eigen::Vector3d(one.raw.mean.x, one.raw.mean.y, one.raw.mean.z);
    one.raw.mean = {mean.x(), mean.y(), mean.z()};
    const auto chain = math::EvaluateChain(one.raw, splat_camera);
    clamped += chain.u != chain.cu || chain.v != chain.cv;
    const CameraNumbers gradient = one.Gradient(splat_camera);
    for (size_t k = 0; k < gradient.size(); ++k) {
      const double step = k < 6 ? 1e-6 : 1e-4;
      const auto loss = [&](double by) {
        CameraNumbers change{};
        change[k] = by;
        return one.Loss(MakeSplatCamera<double>(Changed(camera, change), options));
      };
      const double difference = (loss(step) - loss(-step)) / (2 * step);
      EXPECT_NEAR(gradient[k], difference, 1e-5 * (std::abs(difference) + 0.1)) << i << ", number " << k;
    }
  }
  EXPECT_GT(clamped, 20);
  EXPECT_LT(clamped, 180);
}

INSTANTIATE_TEST_SUITE_P(Modes, CameraGradientOfOne, testing::Bool(),
                         [](const auto& info) { return info.param ? "antialiased" : "plain"; });

struct Watched {
  CameraNumbers camera;
  Gaussians grads;
};

Watched Watch(const PosedScene& scene, const RenderOptions& options, const RenderGrads& up) {
  auto rasterizer = MakeRasterizer(kCpu);
  rasterizer->WatchCamera(true);
  rasterizer->Forward(scene.gaussians, scene.camera, options, RenderPass::kTrain);
  Watched out{{}, Gaussians::Zeros(scene.gaussians.size())};
  rasterizer->Backward(scene.gaussians, up, &out.grads);
  out.camera = NumbersOf(rasterizer->camera_gradient());
  return out;
}

class CameraGradientTargets : public testing::TestWithParam<std::tuple<int64_t, bool>> {
 protected:
  void SetUp() override { hwy::SetSupportedTargetsForTest(std::get<0>(GetParam())); }
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }
};

TEST_P(CameraGradientTargets, MatchesCentralDifferences) {
  const PosedScene scene(25, 0.25, {24, 20});
  const RenderOptions options{{0.1f, 0.5f, 0.9f}, 3, std::get<1>(GetParam())};
  const RenderGrads all = RandomUpstream(scene.camera, 1);
  const RenderGrads none{Buffer<float>::Zeros({20, 24, 3}), Buffer<float>::Zeros({20, 24}),
                         Buffer<float>::Zeros({20, 24})};
  ReferenceScene reference(scene.gaussians, scene.camera, options);
  for (const RenderGrads& up :
       {all, RenderGrads{all.image, none.alpha, none.inv_depth}, RenderGrads{none.image, all.alpha, none.inv_depth},
        RenderGrads{none.image, none.alpha, all.inv_depth}}) {
    const auto loss = [&](const Camera& camera) {
      reference.camera = camera;
      return reference.Loss(up);
    };
    ExpectCameraDifferences(scene.camera, loss, Watch(scene, options, up).camera);
  }
}

INSTANTIATE_TEST_SUITE_P(EveryTarget, CameraGradientTargets,
                         testing::Combine(testing::ValuesIn(hwy::SupportedAndGeneratedTargets()), testing::Bool()),
                         [](const auto& info) {
                           return std::string(hwy::TargetName(std::get<0>(info.param))) +
                                  (std::get<1>(info.param) ? "_antialiased" : "_plain");
                         });

TEST(CameraGradient, HasTheSameBitsForAnyNumberOfThreadsAndChangesNoOther) {
  const PosedScene scene(20000, 0.05, {150, 110});
  const RenderGrads up = RandomUpstream(scene.camera, 2);
  auto unwatched = MakeRasterizer(kCpu);
  unwatched->Forward(scene.gaussians, scene.camera, {}, RenderPass::kTrain);
  Gaussians grads = Gaussians::Zeros(20000);
  unwatched->Backward(scene.gaussians, up, &grads);
  SetNumThreads(1);
  const CameraNumbers one = Watch(scene, {}, up).camera;
  for (const int threads : {2, 3, 7}) {
    SetNumThreads(threads);
    const Watched many = Watch(scene, {}, up);
    EXPECT_EQ(many.camera, one);
    EXPECT_TRUE(SameBytes(many.grads.means, grads.means));
    EXPECT_TRUE(SameBytes(many.grads.log_scales, grads.log_scales));
    EXPECT_TRUE(SameBytes(many.grads.quats, grads.quats));
    EXPECT_TRUE(SameBytes(many.grads.opacity_logits, grads.opacity_logits));
    EXPECT_TRUE(SameBytes(many.grads.sh, grads.sh));
  }
  SetNumThreads(0);
}

/// Moves Gaussians away as soon as their gradients are there.
class MovingConsumer final : public GradientConsumer {
 public:
  explicit MovingConsumer(Gaussians* gaussians) : gaussians_(gaussians) {}
  void ConsumeBlock(int64_t begin, int64_t end, const GaussianRows&) override {
    std::fill_n(gaussians_->means.data() + 3 * begin, 3 * (end - begin), 1e9f);
  }

 private:
  Gaussians* gaussians_;
};

TEST(CameraGradient, IsTheSameWithAConsumerThatMovesTheGaussians) {
  PosedScene scene(500, 0.1, {50, 40});
  const RenderGrads up = RandomUpstream(scene.camera, 2);
  const CameraNumbers wanted = Watch(scene, {}, up).camera;
  auto rasterizer = MakeRasterizer(kCpu);
  rasterizer->WatchCamera(true);
  rasterizer->Forward(scene.gaussians, scene.camera, {}, RenderPass::kTrain);
  MovingConsumer consumer(&scene.gaussians);
  rasterizer->BackwardInto(scene.gaussians, up, &consumer);
  EXPECT_EQ(NumbersOf(rasterizer->camera_gradient()), wanted);
  // The next view does not change what the last pass gave.
  rasterizer->Forward(scene.gaussians, FrontCamera(20, 20), {}, RenderPass::kInference);
  EXPECT_EQ(NumbersOf(rasterizer->camera_gradient()), wanted);
}

TEST(CameraGradient, IsZeroWhereNothingIsSeen) {
  PosedScene scene(40, 0.1, {20, 20});
  const RenderGrads up = RandomUpstream(scene.camera, 2);
  scene.camera.cam_from_world = Eigen::AngleAxisd(3.14159, Eigen::Vector3d::UnitY()) * scene.camera.cam_from_world;
  EXPECT_EQ(Watch(scene, {}, up).camera, CameraNumbers{});
  scene.gaussians = Gaussians::Zeros(0);
  EXPECT_EQ(Watch(scene, {}, up).camera, CameraNumbers{});
}

TEST(CameraGradient, OfOddGaussiansOutOfSightIsFinite) {
  PosedScene scene(40, 0.1, {20, 20});
  const RenderGrads up = RandomUpstream(scene.camera, 2);
  const CameraNumbers without = [&] {
    Gaussians dimmed = scene.gaussians;
    dimmed.opacity_logits = dimmed.opacity_logits.Clone();
    for (int i = 0; i < 3; ++i) dimmed.opacity_logits[i] = -100;
    return Watch(PosedScene{dimmed, scene.camera}, {}, up).camera;
  }();
  for (int i = 0; i < 3; ++i) scene.gaussians.means[3 * i + i] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(Watch(scene, {}, up).camera, without);
}

TEST(CameraGradient, MustHaveBeenAskedFor) {
  const PosedScene scene(10, 0.1, {20, 20});
  auto rasterizer = MakeRasterizer(kCpu);
  EXPECT_THROW(rasterizer->camera_gradient(), ShapeError);
  rasterizer->WatchCamera(true);
  EXPECT_THROW(rasterizer->camera_gradient(), ShapeError);  // no backward pass yet
  rasterizer->Forward(scene.gaussians, scene.camera, {}, RenderPass::kTrain);
  Gaussians grads = Gaussians::Zeros(10);
  rasterizer->Backward(scene.gaussians, {}, &grads);
  EXPECT_NO_THROW(rasterizer->camera_gradient());
  rasterizer->WatchCamera(false);
  rasterizer->Backward(scene.gaussians, {}, &grads);
  EXPECT_THROW(rasterizer->camera_gradient(), ShapeError);
}

}  // namespace
}  // namespace oraclegs
