#include "oraclegs/demo/textures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace oraclegs {
namespace {

TEST(Albedo, EveryTextureIsInRangeAndHasDetail) {
  const Vec3 size{.4, .4, .4};
  for (const Texture texture : {Texture::kRoom, Texture::kCrate, Texture::kQuilt, Texture::kMarble, Texture::kCandy,
                                Texture::kTiles, Texture::kDonut, Texture::kGlaze, Texture::kGround, Texture::kHouse}) {
    double lowest = 1, highest = 0;
    for (int i = 0; i < 400; ++i) {
      const Vec3 p{-.35 + .035 * (i % 20), -.4, -.35 + .035 * (i / 20)};
      const Vec3 color = Albedo(texture, p, {0, -1, 0}, size);
      for (const double v : {color.x, color.y, color.z}) {
        ASSERT_GE(v, 0);
        ASSERT_LE(v, 1);
      }
      lowest = std::min(lowest, color.y);
      highest = std::max(highest, color.y);
    }
    EXPECT_GT(highest - lowest, .15) << static_cast<int>(texture);
  }
}

TEST(Albedo, PaintIsOneColorASide) {
  const auto paint = [](const Vec3& point, const Vec3& normal) {
    return Albedo(Texture::kPaint, point, normal, {3, 3, 2}).x;
  };
  EXPECT_EQ(paint({-1, 3, .2}, {0, 1, 0}), paint({2, 3, -1.7}, {0, 1, 0}));
  EXPECT_NE(paint({3, 1, 0}, {1, 0, 0}), paint({-3, 1, 0}, {-1, 0, 0}));
}

TEST(Albedo, HousesDiffer) {
  const auto plaster = [](const Vec3& size) { return Albedo(Texture::kHouse, {0, -1, .6}, {0, -1, 0}, size).x; };
  EXPECT_NE(plaster({2, 1, 3}), plaster({3, 1, 4}));
}

}  // namespace
}  // namespace oraclegs
