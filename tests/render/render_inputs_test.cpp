#include "oraclegs/render/render_inputs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "render/scenes.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr Device kOtherDevice{DeviceKind::kCuda, 7};

TEST(ForwardParameters, PointToTheBuffers) {
  const Gaussians g = RandomGaussians(5, 0.1, 1);
  RenderOptions options;
  GaussianParameters parameters = ForwardParameters(g, FrontCamera(8, 8), options, kCpu);
  EXPECT_EQ(parameters.means, g.means.data());
  EXPECT_EQ(parameters.sh, g.sh.data());
  EXPECT_EQ(parameters.opacity_factors, nullptr);
  EXPECT_EQ(parameters.n, 5);
  options.opacity_factors = Buffer<float>::Full({5}, 1.f);
  parameters = ForwardParameters(g, FrontCamera(8, 8), options, kCpu);
  EXPECT_EQ(parameters.opacity_factors, options.opacity_factors.data());
}

TEST(ForwardParameters, NamesWhatDoesNotFit) {
  const Gaussians g = RandomGaussians(5, 0.1, 1);
  const auto forward = [&](const Camera& camera, const RenderOptions& options) {
    return [&g, camera, options] { ForwardParameters(g, camera, options, kCpu); };
  };
  EXPECT_THAT(forward(FrontCamera(0, 8), {}), ThrowsMessage<ShapeError>(HasSubstr("image is 0 x 8")));
  EXPECT_THAT(forward(FrontCamera(8, 32769), {}), ThrowsMessage<ShapeError>(HasSubstr("must be in 1 .. 32768")));
  EXPECT_THAT(forward(FrontCamera(8, 8), {{}, 4, false}), ThrowsMessage<ShapeError>(HasSubstr("sh_degree is 4")));
  RenderOptions options;
  options.opacity_factors = Buffer<float>::Full({4}, 1.f);
  EXPECT_THAT(forward(FrontCamera(8, 8), options), ThrowsMessage<ShapeError>(HasSubstr("opacity_factors is [4]")));
  EXPECT_THAT([&] { ForwardParameters(g, FrontCamera(8, 8), {}, kOtherDevice); },
              ThrowsMessage<ShapeError>(HasSubstr("means is on cpu, expected on cuda:7")));
}

TEST(BackwardParameters, NeedAsManyGaussiansAsForwardHad) {
  const Gaussians g = RandomGaussians(5, 0.1, 1);
  EXPECT_EQ(BackwardParameters(g, 5).n, 5);
  EXPECT_THAT([&] { BackwardParameters(g, -1); }, ThrowsMessage<ShapeError>(HasSubstr("5 Gaussians")));
}

TEST(PlanesOf, AreNullWhereNothingIsGiven) {
  const RenderGrads upstream{Buffer<float>::Zeros({4, 6, 3}), {}, Buffer<float>::Zeros({4, 6})};
  const UpstreamPlanes planes = PlanesOf(upstream, 4, 6, kCpu);
  EXPECT_EQ(planes.image, upstream.image.data());
  EXPECT_EQ(planes.alpha, nullptr);
  EXPECT_EQ(planes.inv_depth, upstream.inv_depth.data());
}

TEST(PlanesOf, NameThePlaneThatDoesNotFit) {
  const RenderGrads upstream{{}, Buffer<float>::Zeros({4, 5}), {}};
  EXPECT_THAT([&] { PlanesOf(upstream, 4, 6, kCpu); },
              ThrowsMessage<ShapeError>(HasSubstr("upstream.alpha is [4, 5]")));
  EXPECT_THAT([&] { PlanesOf(upstream, 4, 5, kOtherDevice); }, ThrowsMessage<ShapeError>(HasSubstr("is on cpu")));
}

TEST(GradientRows, NeedARowForEachGaussian) {
  const Gaussians grads = Gaussians::Zeros(5);
  EXPECT_EQ(GradientRows(grads, 5, kCpu).quats, grads.quats.data());
  EXPECT_THAT([&] { GradientRows(grads, 6, kCpu); }, ThrowsMessage<ShapeError>(HasSubstr("hold 5 rows, expected 6")));
}

}  // namespace
}  // namespace oraclegs
