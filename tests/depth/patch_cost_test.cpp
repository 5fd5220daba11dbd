// The correlation against the textbook's, in double precision and sample by sample, for every instruction set.

#include "oraclegs/depth/patch_cost.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "depth/rig.h"
#include "render/cpu/every_target.h"

namespace oraclegs {
namespace {

const TexturedPlane kSurface{{0, 0, 0.5}, Eigen::Vector3d(0.3, -0.2, -1).normalized()};
const Camera kLeftView = CameraAt({-0.5, 0.1, -4}, {0, 0, 0}, 96, 72),
             kRightView = CameraAt({0.6, -0.2, -3.6}, {0, 0, 0}, 96, 72);

GatherImage ImageOf(const Camera& camera, int channels) {
  const ImageF rgb = kSurface.Take(camera, "").rgb;
  return Pack(channels == 1 ? Luma(rgb) : rgb);
}

/// The surface as seen from pixel (x, y) of kLeftView.
Plane TruePlane(int x, int y) {
  const auto inverse = [](double u, double v) { return 1 / kSurface.DepthAt(kLeftView, u, v); };
  const double u = x + 0.5, v = y + 0.5, w = inverse(u, v);
  return {static_cast<float>(w), static_cast<float>(inverse(u + 1, v) - w), static_cast<float>(inverse(u, v + 1) - w)};
}

double Bilinear(const GatherImage& image, int channel, double x, double y) {
  x = std::clamp(x, 0.0, image.width - 1.0), y = std::clamp(y, 0.0, image.height - 1.0);
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const int x1 = std::min(x0 + 1, image.width - 1), y1 = std::min(y0 + 1, image.height - 1);
  const double fx = x - x0, fy = y - y0;
  return (1 - fy) * ((1 - fx) * image.Value(channel, x0, y0) + fx * image.Value(channel, x1, y0)) +
         fy * ((1 - fx) * image.Value(channel, x0, y1) + fx * image.Value(channel, x1, y1));
}

/// 1 - ZNCC of the checkerboard samples around (x, y), weighted by exp(-d^2 / (2 * 4^2)) for the distance d in pixels
/// and exp(-g^2 / (2 * 20^2)) for the mean difference g of the channels; each variance joined by 1.5^2 a channel.
double Reference(const GatherImage& a, int x, int y, const GatherImage& b, const PixelMap& map, const Plane& plane,
                 const std::vector<uint8_t>& usable = {}) {
  const int channels = static_cast<int>(a.channels.size());
  std::vector<double> weights;
  std::vector<std::vector<double>> left(channels), right(channels);
  double total = 0;
  for (int dy = -4; dy <= 4; ++dy) {
    for (int dx = -4; dx <= 4; ++dx) {
      if ((dx + dy) % 2 != 0) continue;
      const int sx = x + dx, sy = y + dy;
      if (sx < 0 || sy < 0 || sx >= a.width || sy >= a.height) continue;
      if (!usable.empty() && usable[static_cast<size_t>(sy) * a.width + sx] == 0) continue;
      const Eigen::Vector3f q = map(static_cast<float>(sx) + 0.5f, static_cast<float>(sy) + 0.5f,
                                    plane.At(static_cast<float>(dx), static_cast<float>(dy)));
      int difference = 0;
      for (int c = 0; c < channels; ++c) {
        difference += std::abs(a.Value(c, sx, sy) - a.Value(c, x, y));
        left[c].push_back(a.Value(c, sx, sy));
        right[c].push_back(Bilinear(b, c, q.x() / q.z() - 0.5, q.y() / q.z() - 0.5));
      }
      difference /= channels;  // in whole steps of 8 bits
      weights.push_back(std::exp(-(dx * dx + dy * dy) / 32.0 - difference * difference / 800.0));
      total += weights.back();
    }
  }
  double cross = 0, left_variance = 0, right_variance = 0;
  for (int c = 0; c < channels; ++c) {
    double left_mean = 0, right_mean = 0;
    for (size_t k = 0; k < weights.size(); ++k) {
      left_mean += weights[k] / total * left[c][k];
      right_mean += weights[k] / total * right[c][k];
    }
    for (size_t k = 0; k < weights.size(); ++k) {
      const double l = left[c][k] - left_mean, r = right[c][k] - right_mean, w = weights[k] / total;
      cross += w * l * r;
      left_variance += w * l * l;
      right_variance += w * r * r;
    }
  }
  const double guard = 2.25 * channels;
  return std::clamp(1 - cross / std::sqrt((left_variance + guard) * (right_variance + guard)), 0.0, 2.0);
}

float CostOf(const Patch& patch, const GatherImage& image, const PixelMap& map, const Plane& plane) {
  const PatchSource source{&image, map};
  const uint8_t active = 1;
  float cost = -1;
  PatchCosts(patch, {{&source, 1}, &active, {&plane, 1}}, &cost);
  return cost;
}

GatherImage Constant(float value) { return Pack({96, 72, 1, std::vector<float>(96 * 72, value)}); }

class PatchCostsTest : public EveryTarget {};

TEST_P(PatchCostsTest, AreOneMinusCorrelation) {
  const PixelMap map = MapBetween(kLeftView, kRightView);
  for (const int channels : {1, 3}) {
    const GatherImage left = ImageOf(kLeftView, channels), right = ImageOf(kRightView, channels);
    int compared = 0;
    for (int y = 1; y < 72; y += 10) {
      for (int x = 0; x < 96; x += 5) {
        const Patch patch = MakePatch(left, x, y, nullptr);
        const Plane truth = TruePlane(x, y);
        for (const float factor : {1.f, 0.97f, 1.2f}) {
          const Plane plane{truth.inv_depth * factor, -truth.dx * factor, truth.dy};
          const float cost = CostOf(patch, right, map, plane);
          if (cost == kWorstCost) continue;  // beyond the image
          EXPECT_NEAR(cost, Reference(left, x, y, right, map, plane), 2e-3) << channels << " " << x << " " << y;
          ++compared;
        }
      }
    }
    EXPECT_GT(compared, 200);
  }
}

TEST_P(PatchCostsTest, IgnoreUnusablePixels) {
  const PixelMap map = MapBetween(kLeftView, kRightView);
  GatherImage left = ImageOf(kLeftView, 1);
  const GatherImage right = ImageOf(kRightView, 1);
  std::vector<uint8_t> usable(96 * 72, 1);
  for (int y = 0; y < 72; ++y) {
    for (int x = 50; x < 96; ++x) usable[static_cast<size_t>(y) * 96 + x] = 0;
  }
  const Plane plane = TruePlane(48, 30);
  const float cost = CostOf(MakePatch(left, 48, 30, usable.data()), right, map, plane);
  EXPECT_NEAR(cost, Reference(left, 48, 30, right, map, plane, usable), 2e-3);
  for (size_t i = 0; i < usable.size(); ++i) left.channels[0][i] = usable[i] != 0 ? left.channels[0][i] : 99;
  EXPECT_EQ(CostOf(MakePatch(left, 48, 30, usable.data()), right, map, plane), cost);
}

TEST_P(PatchCostsTest, AreLowOnSurface) {
  const PixelMap map = MapBetween(kLeftView, kRightView);
  const GatherImage left = ImageOf(kLeftView, 3), right = ImageOf(kRightView, 3);
  double on = 0, beside = 0;
  int n = 0;
  for (int y = 12; y < 60; y += 6) {
    for (int x = 20; x < 76; x += 7, ++n) {
      const Patch patch = MakePatch(left, x, y, nullptr);
      Plane plane = TruePlane(x, y);
      on += CostOf(patch, right, map, plane);
      plane.inv_depth *= 1.1f;
      beside += CostOf(patch, right, map, plane);
    }
  }
  EXPECT_LT(on / n, 0.05);
  EXPECT_GT(beside / n, 0.5);
}

TEST_P(PatchCostsTest, ReachNoiseGuardForEqualPatches) {
  const GatherImage left = ImageOf(kLeftView, 1);
  const Patch patch = MakePatch(left, 40, 30, nullptr);
  ASSERT_GT(patch.variance, 20);
  EXPECT_NEAR(CostOf(patch, left, {}, {0.25f, 0, 0}), 2.25 / (patch.variance + 2.25), 1e-3);
}

TEST_P(PatchCostsTest, AreAboutOneForFlatPatch) {
  const GatherImage flat = Constant(0.5f), left = ImageOf(kLeftView, 1);
  EXPECT_NEAR(CostOf(MakePatch(flat, 40, 30, nullptr), left, {}, {0.25f, 0, 0}), 1, 0.02);
  EXPECT_NEAR(CostOf(MakePatch(left, 40, 30, nullptr), flat, {}, {0.25f, 0, 0}), 1, 0.02);
  EXPECT_NEAR(CostOf(MakePatch(flat, 40, 30, nullptr), flat, {}, {0.25f, 0, 0}), 1, 0.02);
}

TEST_P(PatchCostsTest, AreWorstOutOfFrame) {
  const GatherImage left = ImageOf(kLeftView, 1);
  const Patch patch = MakePatch(left, 40, 30, nullptr);
  const Camera ahead = CameraAt({-0.5, 0.1, 2}, {-0.5, 0.1, 9}, 96, 72);
  EXPECT_EQ(CostOf(patch, left, MapBetween(kLeftView, ahead), TruePlane(40, 30)), kWorstCost);
  const Camera aside = CameraAt({9, 0.1, -4}, {9, 0.1, 0}, 96, 72);
  EXPECT_EQ(CostOf(patch, left, MapBetween(kLeftView, aside), TruePlane(40, 30)), kWorstCost);
  // So steep that a corner of the patch lies behind the other camera: no correlation, and nothing read out of bounds.
  const PixelMap map = MapBetween(kLeftView, kRightView);
  EXPECT_EQ(CostOf(patch, left, map, {0.25f, 30, -30}), kWorstCost);
  EXPECT_EQ(CostOf(patch, left, map, {std::nanf(""), 0, 0}), kWorstCost);
}

TEST_P(PatchCostsTest, AreOrderedPlaneByPlane) {
  const GatherImage left = ImageOf(kLeftView, 3), right = ImageOf(kRightView, 3);
  const Patch patch = MakePatch(left, 40, 30, nullptr);
  const PixelMap map = MapBetween(kLeftView, kRightView);
  const PatchSource sources[] = {{&right, map}, {&right, map}, {&left, {}}};
  const uint8_t active[] = {1, 0, 1};
  const Plane truth = TruePlane(40, 30), planes[] = {truth, {0.9f * truth.inv_depth, 0, 0}};
  float costs[6];
  PatchCosts(patch, {sources, active, planes}, costs);
  for (int p = 0; p < 2; ++p) {
    EXPECT_EQ(costs[3 * p], CostOf(patch, right, map, planes[p]));
    EXPECT_EQ(costs[3 * p + 1], kWorstCost) << "inactive";
    EXPECT_EQ(costs[3 * p + 2], CostOf(patch, left, {}, planes[p]));
  }
}

INSTANTIATE_FOR_EVERY_TARGET(PatchCostsTest);

TEST(MakePatch, WeighsSimilarAndNearPixels) {
  ImageF image{96, 72, 1, {}};
  for (int y = 0; y < 72; ++y) {
    for (int x = 0; x < 96; ++x) image.data.push_back(x < 42 ? 0.2f : 0.8f);
  }
  const Patch patch = MakePatch(Pack(image), 40, 30, nullptr);
  EXPECT_EQ(patch.u, 40.5f);
  EXPECT_EQ(patch.v, 30.5f);
  float sum = 0, beyond_the_edge = 0;
  for (int k = 0; k < kPatchSlots; ++k) {
    sum += patch.weight[k];
    if (Offsets().x[static_cast<size_t>(k)] >= 2) beyond_the_edge += patch.weight[k];
    if (k >= kPatchSamples) {
      EXPECT_EQ(patch.weight[k], 0);
    }
  }
  EXPECT_NEAR(sum, 1, 1e-5);
  EXPECT_LT(beyond_the_edge, 1e-6f);
  EXPECT_LT(patch.variance, 1e-3f) << "what lies beyond an edge does not count";
}

TEST(MakePatch, IgnoresPixelsBeyondCorner) {
  const Patch patch = MakePatch(ImageOf(kLeftView, 1), 0, 0, nullptr);
  float sum = 0;
  for (int k = 0; k < kPatchSamples; ++k) {
    sum += patch.weight[k];
    if (Offsets().x[static_cast<size_t>(k)] < 0 || Offsets().y[static_cast<size_t>(k)] < 0) {
      EXPECT_EQ(patch.weight[k], 0);
    }
  }
  EXPECT_NEAR(sum, 1, 1e-5);
}

}  // namespace
}  // namespace oraclegs
