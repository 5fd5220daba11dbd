#include "oraclegs/networks/seva/conditioning.h"

#include "networks/seva/tiny_seva.h"

namespace oraclegs::seva {
namespace {

/// Three frames, of which the second is given.
Frames SomeFrames() {
  Frames frames{std::vector<View>(3), {false, true, false}, std::vector<Tensor>(3), std::vector<Tensor>(3), 8, 16};
  for (size_t i = 0; i < 3; ++i) {
    frames.views[i].world_from_camera.translation().x() = static_cast<double>(i);
    frames.views[i].intrinsics << 1, 0, 0.5, 0, 1, 0.5, 0, 0, 1;
  }
  frames.latents[1] = at::sin(at::arange(4 * 8 * 16)).view({1, 4, 8, 16});
  frames.embeddings[1] = at::cos(at::arange(kTinyContext)).view({1, kTinyContext});
  return frames;
}

TEST(SevaConditioning, GivenFramesAreMarked) {
  const Frames frames = SomeFrames();
  const NetworkInputs inputs = MakeInputs(frames, torch::kCPU);
  EXPECT_TRUE(torch::equal(inputs.given[1].slice(0, 0, 4), frames.latents[1][0]));
  EXPECT_EQ(inputs.given[1][4].min().item<double>(), 1);
  EXPECT_EQ(inputs.given[0].abs().max().item<double>(), 0);
  EXPECT_EQ(inputs.mask.sum().item<double>(), 8 * 16);
  EXPECT_EQ(inputs.rays.sizes(), (at::IntArrayRef{3, 6, 8, 16}));
  for (int64_t t = 0; t < 3; ++t) EXPECT_TRUE(torch::equal(inputs.context[t], frames.embeddings[1]));
}

TEST(SevaConditioning, ContextIsTheMeanOfTheGivenFrames) {
  Frames frames = SomeFrames();
  frames.given[2] = true;
  frames.latents[2] = frames.latents[1];
  frames.embeddings[2] = 3 * frames.embeddings[1];
  EXPECT_LE(MaxAbsError(MakeInputs(frames, torch::kCPU).context[0], 2 * frames.embeddings[1]), 1e-6);
  EXPECT_LE(frames.embeddings[1].abs().max().item<double>(), 1);
}

TEST(SevaConditioning, HalvesInTurnGiveWhatBatchedOnesGive) {
  const Unet unet = TinyUnet();
  const NetworkInputs inputs = MakeInputs(SomeFrames(), torch::kCPU);
  const Tensor x = at::sin(at::arange(6 * 4 * 8 * 16) * 0.37).view({6, 4, 8, 16});
  const Tensor batched = MakeNetwork(unet, inputs, Halves::kBatched)(x, 500);
  const Tensor in_turn = MakeNetwork(unet, inputs, Halves::kInTurn)(x, 500);
  EXPECT_EQ(batched.sizes(), x.sizes());
  EXPECT_LE(MaxAbsError(batched, in_turn), 1e-4);
  EXPECT_GE(MaxAbsError(batched.slice(0, 0, 3), batched.slice(0, 3)), 1e-2);
}

TEST(SevaConditioning, RefusesListsThatDoNotFit) {
  Frames frames = SomeFrames();
  frames.given[1] = false;
  EXPECT_THROW(MakeInputs(frames, torch::kCPU), ShapeError);
  frames.given.pop_back();
  EXPECT_THROW(MakeInputs(frames, torch::kCPU), ShapeError);
}

}  // namespace
}  // namespace oraclegs::seva
