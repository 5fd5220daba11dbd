#include "oraclegs/demo/textures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace oraclegs {
namespace {

TEST(Albedo, EveryTextureIsInRangeAndHasDetail) {
  const Vec3 size{.4, .4, .4};
  for (const Texture texture : {Texture::kRoom, Texture::kCrate, Texture::kQuilt, Texture::kMarble, Texture::kCandy,
                                Texture::kTiles, Texture::kDonut, Texture::kGlaze}) {
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

}  // namespace
}  // namespace oraclegs
