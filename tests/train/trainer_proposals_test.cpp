// Proposals among what the trainer learns from.

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/render/render.h"
#include "support/buffers.h"
#include "support/temp_dir.h"
#include "train/small_scene.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

/// Proposals of a perfect generator beyond the photos, confident in the left half.
std::vector<TrainView> Proposals(int count) {
  auto views = Photos(count);
  for (int i = 0; i < count; ++i) {
    views[i].name = "proposal" + std::to_string(i);
    views[i].pixel_weight = Buffer<float>::Full({kHeight, kWidth}, 0.25f);
    Table(views[i].pixel_weight).leftCols(kWidth / 2).setConstant(0.9f);
  }
  return views;
}

std::vector<TrainView> WithConfidence(std::vector<TrainView> views, float value) {
  for (TrainView& view : views) view.pixel_weight = Buffer<float>::Full({kHeight, kWidth}, value);
  return views;
}

TrainOptions Constantly(double share, int iterations = 100) {
  TrainOptions options = Options(iterations);
  options.schedule = ScheduleKind::kConstant;
  options.synthetic_floor = share;
  return options;
}

Gaussians After(int steps, const TrainOptions& options, const TrainingData& data) {
  Trainer trainer(options, kSeed, {0, 0, 0}, data, Start());
  for (int i = 0; i < steps; ++i) trainer.Step();
  return trainer.gaussians().Clone();
}

std::vector<std::string> Notes(const TrainOptions& options, const TrainingData& data) {
  std::vector<std::string> notes;
  Trainer(options, kSeed, {0, 0, 0}, data, Start()).Run({}, [&](const Event& event) {
    if (const auto* note = std::get_if<Note>(&event)) notes.push_back(note->text);
  });
  return notes;
}

TEST(TrainerProposalsTest, WithoutConfidenceOnlyTheRegularizersAndNoiseMoveAnything) {
  const auto blind = WithConfidence(Proposals(3), 0);
  const Gaussians after = After(60, Constantly(1), {Photos(3), blind});
  EXPECT_EQ(MaxAbs(after.sh), 0);
  // Which are those of photos that are masked altogether: the views are drawn in the same order.
  EXPECT_TRUE(SameBits(after, After(60, Options(), WithConfidence(Photos(3), 0))));
  auto bright = blind;
  for (TrainView& view : bright) view.image = Buffer<float>::Full(view.image.shape(), 1.f);
  EXPECT_TRUE(SameBits(after, After(60, Constantly(1), {Photos(3), bright})));
}

TEST(TrainerProposalsTest, FullConfidenceIsAPhotoWithOtherWeights) {
  TrainOptions options = Options();
  options.ssim_weight = options.proposal_ssim;
  const Gaussians photos = After(30, options, Photos(3));
  TrainOptions proposals = Constantly(1);
  EXPECT_TRUE(SameBits(After(30, proposals, {Photos(3), WithConfidence(Photos(3), 1)}), photos));
  auto undefined = Photos(3);
  EXPECT_TRUE(SameBits(After(30, proposals, {Photos(3), undefined}), photos));
}

TEST(TrainerProposalsTest, ScheduleNoneNeverDrawsOne) {
  TrainOptions options = Options();
  const Gaussians expected = After(60, options, Photos(3));
  EXPECT_FALSE(SameBits(After(60, options, {Photos(3), Proposals(4)}), expected));
  options.schedule = ScheduleKind::kNone;
  options.synthetic_floor = 1;
  EXPECT_TRUE(SameBits(After(60, options, {Photos(3), Proposals(4)}), expected));
}

TEST(TrainerProposalsTest, ConstantOneDrawsNothingElseWithoutReplacement) {
  auto photos = Photos(2);
  for (TrainView& view : photos) Flat(view.image).setConstant(std::nanf(""));  // would end the run
  Trainer trainer(Constantly(1), kSeed, {0, 0, 0}, {photos, Proposals(5)}, Start());
  for (int round = 0; round < 3; ++round) {
    std::vector<int64_t> left = {0, 1, 2, 3, 4};
    for (int k = 0; k < 5; ++k) {
      trainer.Step();
      const std::vector<int64_t> stack = trainer.MakeCheckpoint().sampler.proposals;
      ASSERT_EQ(stack.size(), left.size() - 1);
      for (const int64_t view : stack) EXPECT_THAT(left, testing::Contains(view));
      left = stack;
    }
  }
  EXPECT_TRUE(trainer.MakeCheckpoint().sampler.photos.empty());
}

TEST(TrainerProposalsTest, ShowWhatPhotosDoNot) {
  // One photo, and proposals of the other side: the error there falls by what they say.
  const auto all = Photos(4);
  const std::vector<TrainView> photos = {all[0]}, proposals = WithConfidence({all[1], all[2], all[3]}, 0.8f);
  const auto error = [&](const TrainingData& data) {
    const Gaussians gaussians = After(150, Constantly(0.5, 150), data);
    auto rasterizer = MakeRasterizer(kCpu);
    const Buffer<float> image = rasterizer->Forward(gaussians, all[3].camera, {}, RenderPass::kInference).image;
    return (Wide(image) - Wide(all[3].image)).abs().mean();
  };
  const double without = error(photos), with = error({photos, proposals});
  EXPECT_LT(with, 0.8 * without);
}

TEST(TrainerProposalsTest, SameBitsForAnyNumberOfThreadsAndResumed) {
  TempDir dir;
  const TrainOptions options = Constantly(0.4);
  const TrainingData data{Photos(3), Proposals(4)};
  const auto run = [&](int threads) {
    const Threads scope(threads);
    Trainer trainer(options, kSeed, {0, 0, 0}, data, Start());
    trainer.Run({dir.path(), 45, {}}, Silent());
    return trainer.gaussians().Clone();
  };
  const Gaussians one = run(1);
  EXPECT_TRUE(SameBits(one, run(3)));
  for (const int64_t from : {45, 90}) {
    Trainer resumed(options, kSeed, {0, 0, 0}, data, Start());
    resumed.Restore(ReadCheckpoint(CheckpointPath(dir.path(), from)));
    resumed.Run({}, Silent());
    EXPECT_TRUE(SameBits(resumed.gaussians(), one)) << from;
  }
}

TEST(TrainerProposalsTest, RefusesCheckpointsOfAnotherNumberOfViews) {
  Trainer trainer(Constantly(0.5), kSeed, {0, 0, 0}, {Photos(3), Proposals(4)}, Start());
  for (int i = 0; i < 3; ++i) trainer.Step();
  const Checkpoint checkpoint = trainer.MakeCheckpoint();
  for (const int count : {0, 2, 5}) {
    Trainer other(Constantly(0.5), kSeed, {0, 0, 0}, {Photos(3), Proposals(count)}, Start());
    try {
      other.Restore(checkpoint);
      ADD_FAILURE() << "was accepted with " << count << " proposals";
    } catch (const InputError& e) {
      EXPECT_THAT(e.what(), HasSubstr(fmt::format("3 photos and 4 proposals, this run has 3 and {}", count)));
    }
  }
  Trainer fewer(Constantly(0.5), kSeed, {0, 0, 0}, {Photos(2), Proposals(4)}, Start());
  EXPECT_THROW(fewer.Restore(checkpoint), InputError);
}

TEST(TrainerProposalsTest, AsksLpipsOnceAnIteration) {
  const TrainingData data{Photos(2), Proposals(2)};
  int asked = 0;
  const PerceptualDistance lpips = [&](auto&&...) { return static_cast<double>(++asked); };
  EXPECT_TRUE(Notes(Constantly(1, 5), {data.photos, data.proposals, lpips}).empty());
  EXPECT_EQ(asked, 5);
}

TEST(TrainerProposalsTest, RefusesSharesThatLeaveL1LessThanNothing) {
  TrainOptions options = Options();
  options.proposal_ssim = 0.8;
  EXPECT_THROW(Trainer(options, kSeed, {0, 0, 0}, Photos(2), Start()), UsageError);
  options.proposal_lpips = 0.2;
  EXPECT_NO_THROW(Trainer(options, kSeed, {0, 0, 0}, Photos(2), Start()));
}

}  // namespace
}  // namespace oraclegs
