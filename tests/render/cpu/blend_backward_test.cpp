#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <hwy/aligned_allocator.h>

#include <array>
#include <cmath>
#include <vector>

#include "render/cpu/every_target.h"
#include "render/cpu/splats.h"

namespace oraclegs {
namespace {

class BlendTileBackward : public EveryTarget {};

/// An image that begins in tile (1, 1) of a wider one, its upstream gradients, and the tile's list.
struct Work {
  int width, height;
  std::vector<cpu::LineSplat> splats;
  std::vector<cpu::TileEntry> entries;
  std::vector<float> up_image, up_alpha, up_depth;
  std::array<float, 3> background{0.2f, 0.3f, 0.4f};

  Work(int w, int h, std::vector<cpu::LineSplat> all) : width(w), height(h), splats(std::move(all)) {
    Rng rng(1, RandomStream::kInitialPoints);
    for (uint32_t i = 0; i < splats.size(); ++i) {  // records in another order than the list
      entries.push_back({i, 0xffff, static_cast<uint32_t>(splats.size()) - 1 - i});
    }
    up_image.resize(3 * w * h), up_alpha.resize(w * h), up_depth.resize(w * h);
    for (auto* plane : {&up_image, &up_alpha, &up_depth}) {
      for (float& v : *plane) v = static_cast<float>(rng.Uniform(-1, 1));
    }
  }

  /// Records of the list, entry by entry; unwritten ones are NaN.
  std::vector<std::array<float, 12>> Run() const {
    const int tiles_x = (width + kTile - 1) / kTile;
    std::vector<float> image(3 * width * height), alpha(width * height), inv_depth(width * height);
    std::vector<float> transmittance(256 * (tiles_x + 2));
    std::vector<uint32_t> end(256 * (tiles_x + 2));
    const cpu::BlendImage planes{width,
                                 height,
                                 {background[0], background[1], background[2]},
                                 image.data(),
                                 alpha.data(),
                                 inv_depth.data(),
                                 transmittance.data(),
                                 end.data()};
    const auto count = static_cast<int64_t>(entries.size());
    const cpu::TileWork tile{splats.data(), entries.data(), count, 0, 1, 1, tiles_x + 1};
    cpu::BlendTile(tile, planes);
    auto records = hwy::AllocateAligned<float>(count * cpu::kGradStride);
    std::fill_n(records.get(), count * cpu::kGradStride, NAN);
    cpu::BlendTileBackward(tile, planes, {up_image.data(), up_alpha.data(), up_depth.data()}, records.get());
    std::vector<std::array<float, 12>> rows(count);
    for (int64_t i = 0; i < count; ++i) std::copy_n(&records[entries[i].pair * cpu::kGradStride], 12, rows[i].begin());
    return rows;
  }

  /// Adds one pixel's terms, in double (docs/method.md#blending-gradient).
  void AddPixel(int x, int y, std::vector<std::array<double, 12>>* sums, std::vector<double>* sizes) const {
    struct Hit {
      size_t entry;
      double alpha, t, value;
      bool capped;
    };
    const float* g = &up_image[3 * (width * y + x)];
    std::vector<Hit> hits;
    double t = 1;
    for (size_t i = 0; i < entries.size(); ++i) {
      if (!(entries[i].mask >> (y % 16 / 4 * 4 + x % 16 / 4) & 1)) continue;
      const cpu::LineSplat& s = splats[entries[i].id];
      const double raw = AlphaAt(s, x + 0.5, y + 0.5), a = std::min(raw, 0.99);
      if (a < 1.0 / 255) continue;
      if (t * (1 - a) < 1e-4) break;
      hits.push_back({i, a, t, g[0] * s.r + g[1] * s.g + g[2] * s.b + up_depth[width * y + x] * s.inv_z, raw > 0.99});
      t *= 1 - a;
    }
    double behind = g[0] * background[0] + g[1] * background[1] + g[2] * background[2] - up_alpha[width * y + x];
    for (size_t k = hits.size(); k-- > 0;) {
      const Hit& hit = hits[k];
      const double w = hit.alpha * hit.t, h = hit.capped ? 0 : w * (hit.value - behind);
      behind += hit.alpha * (hit.value - behind);
      const double px = x + 0.5 - 24, py = y + 0.5 - 24;
      const double terms[12] = {h, h * px, h * py,   h * px * px, h * px * py, h * py * py,
                                0, 0,      w * g[0], w * g[1],    w * g[2],    w * up_depth[width * y + x]};
      for (int c = 0; c < 12; ++c) (*sums)[hit.entry][c] += terms[c];
      (*sizes)[hit.entry] += std::abs(h) * (1 + px * px + py * py) + w;
    }
  }

  /// Compares all records. A decision at a threshold may fall the other way in float: a few records may be off by one
  /// pixel's terms.
  void Check(double off_share) const {
    std::vector<std::array<double, 12>> sums(entries.size(), std::array<double, 12>{});
    std::vector<double> sizes(entries.size());
    for (int y = 16; y < std::min(32, height); ++y) {
      for (int x = 16; x < std::min(32, width); ++x) AddPixel(x, y, &sums, &sizes);
    }
    const auto rows = Run();
    int64_t off = 0;
    for (size_t i = 0; i < entries.size(); ++i) {
      for (int c = 0; c < 12; ++c) {
        if (c == 6 || c == 7) continue;  // not used
        ASSERT_TRUE(std::isfinite(rows[i][c])) << i << ' ' << c;
        off += !(std::abs(rows[i][c] - sums[i][c]) <= 3e-4 * (1e-3 + sizes[i]));
      }
    }
    EXPECT_LE(static_cast<double>(off), off_share * 10 * static_cast<double>(entries.size()));
  }
};

TEST_P(BlendTileBackward, WritesTheMoments) {
  const double first_cov[3] = {30, 8, 20}, second_cov[3] = {60, -10, 40};
  Work(32, 32, {MakeSplat(21, 26, first_cov, 0.7, 2), MakeSplat(27, 22, second_cov, 0.6, 5)}).Check(0);
}

TEST_P(BlendTileBackward, HandlesManyChunksAndSegments) {
  Rng rng(8, RandomStream::kInitialPoints);
  for (const bool opaque : {false, true}) {  // pixels that close early, and pixels that never do
    std::vector<cpu::LineSplat> splats;
    for (int i = 0; i < 700; ++i) {
      const double cov[3] = {rng.Uniform(1, 30), 0, rng.Uniform(1, 30)};
      splats.push_back(MakeSplat(rng.Uniform(14, 34), rng.Uniform(14, 34), cov,
                                 opaque ? rng.Uniform(0.01, 0.9) : rng.Uniform(0.005, 0.03), rng.Uniform(1, 9)));
    }
    Work work(32, 32, splats);
    for (cpu::TileEntry& entry : work.entries) entry.mask = static_cast<uint32_t>(rng.Index(1 << 16));
    work.Check(0.02);
  }
}

TEST_P(BlendTileBackward, IgnoresPixelsOutsideTheImage) {
  // The image ends inside a block: what the list would leave of the light beyond is less than a float can hold.
  const double cov[3] = {1, 0, 1};
  Work(29, 30, std::vector<cpu::LineSplat>(60, MakeSplat(31.5, 18.5, cov, 0.999))).Check(0);
}

TEST_P(BlendTileBackward, HasOnlyColorGradientsAtTheCap) {
  const double wide[3] = {1e8, 0, 1e8};
  const std::vector<cpu::LineSplat> splats = {MakeSplat(8, 8, wide, 0.999)};
  const std::vector<cpu::TileEntry> entries = {{0, 0xffff, 0}};
  std::vector<float> image(3 * 256), alpha(256), inv_depth(256), transmittance(256), up(3 * 256, 1.f);
  std::vector<uint32_t> end(256);
  const cpu::BlendImage planes{
      16, 16, {0, 0, 0}, image.data(), alpha.data(), inv_depth.data(), transmittance.data(), end.data()};
  cpu::BlendTile({splats.data(), entries.data(), 1, 0, 0, 0, 0}, planes);
  auto records = hwy::AllocateAligned<float>(cpu::kGradStride);
  cpu::BlendTileBackward({splats.data(), entries.data(), 1, 0, 0, 0, 0}, planes, {up.data(), nullptr, nullptr},
                         records.get());
  for (int k = 0; k < 6; ++k) EXPECT_EQ(records[k], 0) << k;
  EXPECT_NEAR(records[8], 256 * 0.99, 1e-2);
  EXPECT_EQ(records[11], 0);
}

INSTANTIATE_FOR_EVERY_TARGET(BlendTileBackward);

}  // namespace
}  // namespace oraclegs
