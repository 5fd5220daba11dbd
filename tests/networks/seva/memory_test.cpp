#include "oraclegs/networks/seva/memory.h"

#include "networks/fixtures.h"

namespace oraclegs::seva {
namespace {

constexpr int64_t kGigabyte = 1000000000;

MemoryRequest Request(int64_t frames, torch::ScalarType type, Halves halves) {
  MemoryRequest request;
  request.frames = frames;
  request.type = type;
  request.halves = halves;
  request.gpu = true;
  return request;
}

TEST(SevaMemory, EstimatesWhatTheSpecificationDerives) {
  const UnetConfig config;
  const Memory few = EstimateMemory(config, Request(21, torch::kBFloat16, Halves::kBatched));
  EXPECT_NEAR(static_cast<double>(few.weights), 2.53e9, 0.01e9);
  EXPECT_NEAR(static_cast<double>(few.skips), 0.71e9, 0.02e9);
  EXPECT_LE(few.total(), 12 * kGigabyte);  // in 24 GB, with the other networks beside it
  const Memory many = EstimateMemory(config, Request(80, torch::kBFloat16, Halves::kBatched));
  EXPECT_NEAR(static_cast<double>(many.skips), 2.7e9, 0.05e9);
  EXPECT_GE(many.total(), 12 * kGigabyte);
  EXPECT_LE(many.total(), 30 * kGigabyte);
  const Memory half = EstimateMemory(config, Request(80, torch::kBFloat16, Halves::kInTurn));
  EXPECT_EQ(2 * half.activations, many.activations);
  EXPECT_EQ(2 * half.skips, many.skips);
}

TEST(SevaMemory, TakesWhatFits) {
  const UnetConfig config;
  const MemoryRequest request = Request(80, torch::kBFloat16, Halves::kBatched);
  MemoryRequest in_turn = request;
  in_turn.halves = Halves::kInTurn;
  const int64_t batched_bytes = EstimateMemory(config, request).total();
  const int64_t in_turn_bytes = EstimateMemory(config, in_turn).total();
  EXPECT_EQ(ChooseHalves(config, request, {}, batched_bytes), Halves::kBatched);
  EXPECT_EQ(ChooseHalves(config, request, {}, batched_bytes - 1), Halves::kInTurn);
  EXPECT_THROW(ChooseHalves(config, request, {}, in_turn_bytes - 1), RunError);
  SevaOptions options;
  options.halves = Halves::kInTurn;
  EXPECT_EQ(ChooseHalves(config, request, options, batched_bytes), Halves::kInTurn);
  options.halves = Halves::kBatched;
  EXPECT_THROW(ChooseHalves(config, request, options, batched_bytes - 1), RunError);
}

TEST(SevaMemory, SaysWhatLowersTheNeed) {
  const UnetConfig config;
  const auto message = [&](const MemoryRequest& request, Auto<Halves> halves) -> std::string {
    SevaOptions options;
    options.halves = halves;
    try {
      ChooseHalves(config, request, options, kGigabyte);
    } catch (const RunError& error) {
      return error.what();
    }
    return "fits";
  };
  EXPECT_THAT(message(Request(80, torch::kFloat, Halves::kBatched), Halves::kBatched),
              testing::AllOf(testing::HasSubstr("for 80 frames of 576 x 576"), testing::HasSubstr("1.0 GB are there"),
                             testing::HasSubstr("less is needed with --set seva-halves=in-turn ("),
                             testing::HasSubstr("--set seva-precision=bfloat16 ("),
                             testing::HasSubstr("--seva-frames 21 ("), testing::HasSubstr("--seva-short-side 384 (")));
  MemoryRequest small = Request(5, torch::kBFloat16, Halves::kBatched);
  small.size = {64, 64};
  EXPECT_THAT(message(small, {}), testing::HasSubstr("more memory is needed"));
}

TEST(SevaMemory, DecodesInOneTileWhereThatFits) {
  TileRequest request{{768, 576}, 1000, {500, 10, 20, 100}};
  const int64_t pixels = 96 * 72, whole = 1500 + 120 * pixels;
  EXPECT_EQ(ChooseTile(request, whole), 96);
  EXPECT_EQ(ChooseTile(request, whole - 1), 80);  // 80 x 72 at a time
  EXPECT_EQ(ChooseTile(request, 1500 + 20 * pixels + 100 * 64 * 64), 64);
  EXPECT_EQ(ChooseTile(request, 1500 + 20 * pixels + 100 * 64 * 64 - 1), 48);
  const int64_t least = 1500 + 20 * pixels + 100 * 32 * 32;
  EXPECT_EQ(ChooseTile(request, least), 32);
  EXPECT_THROW(ChooseTile(request, least - 1), RunError);
  request.takes.encode = 200;  // there are no tiles when encoding
  EXPECT_EQ(ChooseTile(request, 1500 + 200 * pixels), 96);
  try {
    ChooseTile(request, whole);
    FAIL() << "fits";
  } catch (const RunError& error) {
    EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr("images of 768 x 576"),
                                             testing::HasSubstr("a smaller --seva-short-side")));
  }
  EXPECT_EQ(ChooseTile({{64, 64}, 0, {}}, 0), 8);
}

TEST(SevaMemory, EstimatesWhatTheAutoencoderHolds) {
  const AutoencoderMemory full = EstimateAutoencoder({}, torch::kFloat),
                          half = EstimateAutoencoder({}, torch::kBFloat16);
  // What the process held at most in seva_parts_bench: 1668 and 1134 MiB, its weights with it.
  const double pixels = 72.0 * 72;
  EXPECT_NEAR(static_cast<double>(full.frame + full.tile) * pixels, 1.75e9, 0.1e9);
  EXPECT_NEAR(static_cast<double>(full.encode) * pixels, 1.2e9, 0.1e9);
  EXPECT_LT(half.tile, full.tile);
  EXPECT_LT(half.encode, full.encode);
  EXPECT_LT(10 * full.frame, full.tile);
}

}  // namespace
}  // namespace oraclegs::seva
