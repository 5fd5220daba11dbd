#include "oraclegs/networks/seva/vae_tiles.h"

#include "networks/seva/vae_fixture.h"

namespace oraclegs::seva {
namespace {

TEST(VaeTiles, EveryPixelIsAMeanOfTiles) {
  for (const int64_t length : {20, 32, 33, 47, 48, 49, 100, 161}) {
    for (const int64_t overlap : {1, 8, 16}) {
      const TiledAxis axis = TileAxis(length, {32, overlap}, 4);
      const int64_t count = static_cast<int64_t>(axis.starts.size());
      ASSERT_EQ(axis.weights.sizes(), at::IntArrayRef({count, 4 * axis.side}));
      EXPECT_EQ(axis.starts.front(), 0);
      EXPECT_EQ(axis.starts.back() + axis.side, length);
      EXPECT_GE(axis.weights.min().item<float>(), 0);
      const Tensor sum = torch::zeros({4 * length});
      for (int64_t t = 0; t < count; ++t) {
        const int64_t start = axis.starts[static_cast<size_t>(t)];
        if (t > 0) {
          EXPECT_GE(axis.starts[static_cast<size_t>(t - 1)] + axis.side - start, overlap);
        }
        sum.narrow(0, 4 * start, 4 * axis.side).add_(axis.weights[t]);
      }
      EXPECT_LT(MaxAbsError(sum, torch::ones({4 * length})), 1e-6) << length << " " << overlap;
    }
  }
}

TEST(VaeTiles, TheOuterQuartersOfAnOverlapAreNotUsed) {
  const TiledAxis axis = TileAxis(48, {32, 16}, 8);
  ASSERT_EQ(axis.starts, (std::vector<int64_t>{0, 16}));
  const int64_t quarter = 8 * 16 / 4, pixels = 8 * 32;
  EXPECT_EQ(axis.weights[1].slice(0, 0, quarter).max().item<float>(), 0);
  EXPECT_EQ(axis.weights[0].slice(0, pixels - quarter).max().item<float>(), 0);
  EXPECT_EQ(axis.weights[0].slice(0, 0, pixels - 3 * quarter).min().item<float>(), 1);
  EXPECT_EQ(axis.weights[1].slice(0, 3 * quarter).min().item<float>(), 1);
}

TEST(VaeTiles, AFrameOfOneTileIsThePlainDecode) {
  const SafetensorsFile file = OpenGolden(kVaeFixture);
  const Vae vae = GoldenVae(file);
  const Tensor latents = GoldenFloat(file, "input.latent");
  EXPECT_TRUE(torch::equal(DecodeTiled(vae, latents, {12, 4}), DecodeLatents(vae, latents)));
  EXPECT_TRUE(torch::equal(DecodeTiled(vae, latents, {}), DecodeLatents(vae, latents)));
}

/// Waves of `period` latent pixels, of about unit variance.
Tensor Waves(int64_t height, int64_t width, double period) {
  const Tensor y = torch::arange(height).view({1, -1, 1}) * (6.283185 / period);
  const Tensor x = torch::arange(width) * (6.283185 / period);
  const Tensor phase = torch::tensor({0.3f, 1.1f, 2.3f, 4.1f}).view({4, 1, 1});
  return ((at::sin(x + phase) + at::cos(y - 2 * phase)).unsqueeze(0) * 0.18215).to(torch::kFloat).contiguous();
}

double TiledError(const Vae& vae, const Tensor& latents) {
  const Tensor plain = DecodeLatents(vae, latents), tiled = DecodeTiled(vae, latents, {48, 24});
  EXPECT_EQ(tiled.sizes(), plain.sizes());
  return RelativeL2(tiled, plain);
}

/// Group norms are the only difference between tiles of a smooth frame and the frame: where every tile has about the
/// statistics of the frame the decodes are nearly equal, and nearer than where it does not.
TEST(VaeTiles, TilesThatHoldWhatTheFrameHoldsAreNearThePlainDecode) {
  const SafetensorsFile file = OpenGolden(kVaeFixture);
  const Vae vae = GoldenVae(file);
  const double alike = TiledError(vae, Waves(60, 72, 12)), unlike = TiledError(vae, Waves(60, 72, 140));
  RecordProperty("alike", std::to_string(alike));
  RecordProperty("unlike", std::to_string(unlike));
  EXPECT_LT(alike, 0.1);
  EXPECT_GT(alike, 0);
  EXPECT_GT(unlike, alike);
}

TEST(VaeTiles, SameBitsForAnyNumberOfThreads) {
  const SafetensorsFile file = OpenGolden(kVaeFixture);
  const Vae vae = GoldenVae(file);
  const auto run = [&](int threads) {
    at::set_num_threads(threads);
    return DecodeTiled(vae, Waves(20, 28, 24), {12, 4});
  };
  const int before = at::get_num_threads();
  const Tensor one = run(1), three = run(3);
  at::set_num_threads(before);
  EXPECT_TRUE(torch::equal(one, three));
}

TEST(VaeTiles, RefusesTilesThatDoNotOverlapOrOverlapTooMuch) {
  const SafetensorsFile file = OpenGolden(kVaeFixture);
  const Vae vae = GoldenVae(file);
  const Tensor latents = GoldenFloat(file, "input.latent");
  EXPECT_THAT(
      [&] {
        DecodeTiled(vae, latents, {8, 5});
      },
      testing::ThrowsMessage<ShapeError>("DecodeTiled: tiles of 8 with an overlap of 5, expected an overlap of "
                                         "at least 1 and at most half"));
  EXPECT_THROW(DecodeTiled(vae, latents, {8, 0}), ShapeError);
  EXPECT_THROW(DecodeTiled(vae, latents, {0, 0}), ShapeError);
  EXPECT_THAT(
      [&] {
        DecodeTiled(vae, torch::rand({4, 8, 8}), {});
      },
      testing::ThrowsMessage<ShapeError>(testing::StartsWith("DecodeTiled: the latents are [4, 8, 8] Float")));
}

}  // namespace
}  // namespace oraclegs::seva
