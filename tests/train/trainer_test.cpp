#include "oraclegs/train/trainer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>

#include "oraclegs/core/interrupt.h"
#include "oraclegs/train/loss_terms.h"
#include "oraclegs/train/train_device.h"
#include "support/buffers.h"
#include "support/errors.h"
#include "support/temp_dir.h"
#include "train/small_scene.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

Trainer MakeTrainer(const TrainOptions& options, int views = 4) {
  return Trainer(options, kSeed, {0, 0, 0}, Photos(views), Start());
}

TEST(TrainerTest, LearnsTheScene) {
  constexpr int kIterations = 200;
  Trainer trainer = MakeTrainer(Options(kIterations));
  double first = 0, last = 0;
  for (int i = 0; i < kIterations; ++i) {
    const double loss = trainer.Step();
    if (i < 20) first += loss;
    if (i >= kIterations - 20) last += loss;
  }
  EXPECT_LT(last, 0.5 * first) << first << " " << last;
  EXPECT_EQ(trainer.iteration(), kIterations);
  EXPECT_EQ(trainer.gaussians().size(), 80);
}

TEST(TrainerTest, SameBitsForAnyNumberOfThreads) {
  const auto run = [](int threads) {
    const Threads scope(threads);
    Trainer trainer = MakeTrainer(Options());
    trainer.Run({}, Silent());
    return trainer.gaussians().Clone();
  };
  const Gaussians one = run(1);
  EXPECT_TRUE(SameBits(one, run(2)));
  EXPECT_TRUE(SameBits(one, run(5)));
}

TEST(TrainerTest, ResumingGivesTheBitsOfAnUninterruptedRun) {
  TempDir dir;
  const nlohmann::json options = {{"iterations", 100}};
  Trainer whole = MakeTrainer(Options());
  whole.Run({}, Silent());
  {
    Trainer first = MakeTrainer(Options());
    first.Run({dir.path(), 45, options}, Silent());
    EXPECT_TRUE(SameBits(first.gaussians(), whole.gaussians()));  // saving changes nothing
  }
  for (const int64_t from : {45, 90}) {
    Trainer resumed = MakeTrainer(Options());
    const Checkpoint checkpoint = ReadCheckpoint(CheckpointPath(dir.path(), from));
    resumed.Restore(checkpoint);
    EXPECT_EQ(resumed.iteration(), from);
    const TrainResult result = resumed.Run({dir.path(), 0, options}, Silent());
    EXPECT_EQ(result.iterations, 100);
    EXPECT_EQ(result.steps, 100 - from);
    EXPECT_GT(result.seconds, checkpoint.seconds);
    EXPECT_TRUE(SameBits(resumed.gaussians(), whole.gaussians())) << from;
    EXPECT_TRUE(SameBits(resumed.MakeCheckpoint().adam.v, whole.MakeCheckpoint().adam.v)) << from;
  }
}

TEST(TrainerTest, SmallMomentsResumeToTheSameBitsAndLearnAsWell) {
  TrainOptions options = Options();
  options.sh_moments = ShMoments::kFull;
  Trainer full = MakeTrainer(options);
  full.Run({}, Silent());
  for (const ShMoments sh_moments : {ShMoments::kHalf, ShMoments::kCompact}) {
    const TempDir dir;
    options.sh_moments = sh_moments;
    Trainer whole = MakeTrainer(options);
    whole.Run({dir.path(), 45, {}}, Silent());
    EXPECT_LT(whole.MakeCheckpoint().loss, (sh_moments == ShMoments::kHalf ? 1.03 : 1.1) * full.MakeCheckpoint().loss);
    Trainer resumed = MakeTrainer(options);
    resumed.Restore(ReadCheckpoint(CheckpointPath(dir.path(), 45)));
    resumed.Run({}, Silent());
    EXPECT_TRUE(SameBits(resumed.gaussians(), whole.gaussians()));
    EXPECT_FALSE(SameBits(full.gaussians(), whole.gaussians()));
    EXPECT_TRUE(Equal(resumed.MakeCheckpoint().adam.sh_m, whole.MakeCheckpoint().adam.sh_m));
  }
}

TEST(TrainerTest, InterruptSavesAndTheRunContinuesToTheSameBits) {
  TempDir dir;
  Trainer whole = MakeTrainer(Options());
  whole.Run({}, Silent());
  Trainer stopped = MakeTrainer(Options());
  for (int i = 0; i < 33; ++i) stopped.Step();
  RequestInterrupt(true);
  try {
    stopped.Run({dir.path(), 0, {}}, Silent());
    ADD_FAILURE() << "was not interrupted";
  } catch (const Interrupted& e) {
    EXPECT_THAT(e.what(), HasSubstr("iteration 33 of 100"));
    EXPECT_THAT(e.what(), HasSubstr("iteration_0000033.safetensors"));
    EXPECT_THAT(e.what(), HasSubstr("again to continue"));
  }
  EXPECT_THROW(stopped.Run({}, Silent()), Interrupted);  // nowhere to save
  RequestInterrupt(false);
  Trainer resumed = MakeTrainer(Options());
  resumed.Restore(ReadCheckpoint(*NewestCheckpoint(dir.path())));
  resumed.Run({dir.path(), 0, {}}, Silent());
  EXPECT_TRUE(SameBits(resumed.gaussians(), whole.gaussians()));
}

TEST(TrainerTest, KeepsTwoCheckpoints) {
  TempDir dir;
  MakeTrainer(Options()).Run({dir.path(), 20, {}}, Silent());
  std::vector<std::string> left;
  for (const auto& entry : std::filesystem::directory_iterator(dir.path())) left.push_back(entry.path().filename());
  EXPECT_THAT(left, testing::UnorderedElementsAre("iteration_0000080.safetensors", "iteration_0000100.safetensors"));
}

TEST(TrainerTest, AFirstStepIsAsLongAsTheRateScale) {
  TrainOptions slow = Options(), fast = Options();
  fast.rate_scale = 3.;
  Trainer a = MakeTrainer(slow), b = MakeTrainer(fast);
  const Gaussians start = a.gaussians().Clone();
  a.Step(), b.Step();
  int moved = 0;
  for (int64_t i = 0; i < start.opacity_logits.count(); ++i) {
    const float step = a.gaussians().opacity_logits[i] - start.opacity_logits[i];
    EXPECT_NEAR(b.gaussians().opacity_logits[i] - start.opacity_logits[i], 3 * step, 1e-5f);
    moved += std::abs(step) > 0.01f;
  }
  EXPECT_GT(moved, 0);
}

TEST(TrainerTest, TheLastIterationMovesNothing) {
  Trainer trainer = MakeTrainer(Options(35));
  for (int i = 0; i < 34; ++i) trainer.Step();
  const Gaussians before = trainer.gaussians().Clone();
  EXPECT_GT(trainer.Step(), 0);
  EXPECT_TRUE(SameBits(before, trainer.gaussians()));
  EXPECT_EQ(trainer.MakeCheckpoint().adam.step, 34);
}

TEST(TrainerTest, TheLastIterationDoesNotRefineWhateverTheHorizon) {
  TrainOptions options = Options(40);  // 40 is a multiple of refine_every, and growth would go on for long
  options.horizon = 200;
  options.max_gaussians = 1000;
  Trainer trainer = MakeTrainer(options);
  for (int i = 0; i < 39; ++i) trainer.Step();
  const Gaussians before = trainer.gaussians().Clone();
  trainer.Step();
  EXPECT_TRUE(SameBits(before, trainer.gaussians()));
}

TEST(TrainerTest, AHorizonIsARunThatStopsEarly) {
  TrainOptions whole = Options(100);
  TrainOptions part = Options(60);
  part.horizon = 100;
  Trainer a = MakeTrainer(whole), b = MakeTrainer(part);
  for (int i = 0; i < 59; ++i) a.Step(), b.Step();
  EXPECT_TRUE(SameBits(a.gaussians(), b.gaussians()));
  Trainer other = MakeTrainer(Options(60));
  for (int i = 0; i < 59; ++i) other.Step();
  EXPECT_FALSE(SameBits(a.gaussians(), other.gaussians())) << "its rates fall faster";
}

TEST(TrainerTest, GrowsOnScheduleOnly) {
  TrainOptions options = Options(100);
  options.refine_stop = 0.6;
  options.max_gaussians = 1000;
  Trainer trainer = MakeTrainer(options);
  int64_t size = trainer.gaussians().size();
  for (int i = 1; i <= 100; ++i) {
    trainer.Step();
    const bool refines = i == 40 || i == 50;  // 30 < i < 60
    EXPECT_EQ(trainer.gaussians().size() > size, refines) << i;
    size = trainer.gaussians().size();
  }
}

TEST(TrainerTest, ShDegreeFollowsTheScheduleAndItsLimit) {
  TrainOptions options = Options(100);
  options.sh_degree = 1;
  Trainer trainer = MakeTrainer(options);
  for (int i = 1; i <= 19; ++i) trainer.Step();
  EXPECT_EQ(Table(trainer.gaussians().sh).rightCols(45).abs().maxCoeff(), 0);
  for (int i = 20; i <= 100; ++i) trainer.Step();
  EXPECT_GT(Table(trainer.gaussians().sh).middleCols(3, 9).abs().maxCoeff(), 0);
  EXPECT_EQ(Table(trainer.gaussians().sh).rightCols(36).abs().maxCoeff(), 0);
}

TEST(TrainerTest, WhatTheMaskHidesIsNoLoss) {
  // The true Gaussians, and photos that are wrong in their masked half only: SSIM windows that reach across must
  // not see the difference.
  auto views = Photos(3);
  for (TrainView& view : views) {
    view.pixel_weight = Buffer<float>::Full({kHeight, kWidth}, 1.f);
    Table(view.pixel_weight).rightCols(kWidth - 20).setZero();
    Table(view.image).rightCols(3 * (kWidth - 20)).setConstant(0.9f);
  }
  TrainOptions options = Options();
  options.opacity_reg = options.scale_reg = 0;
  Trainer trainer(options, kSeed, {0, 0, 0}, views, Truth());
  EXPECT_NEAR(trainer.Step(), 0, 1e-5);
  for (TrainView& view : views) view.pixel_weight = Buffer<float>();
  Trainer unmasked(options, kSeed, {0, 0, 0}, views, Truth());
  EXPECT_GT(unmasked.Step(), 0.1);
}

TEST(TrainerTest, WhatTheMaskHidesGivesNoGradient) {
  auto views = Photos(2);
  for (TrainView& view : views) view.pixel_weight = Buffer<float>::Zeros({kHeight, kWidth});
  Trainer blind(Options(60), kSeed, {0, 0, 0}, views, Start());
  for (int i = 0; i < 25; ++i) blind.Step();  // regularizers and noise only: no color changes
  EXPECT_EQ(MaxAbs(blind.gaussians().sh), 0);
}

TEST(TrainerTest, AMaskOfOnesIsNoMask) {
  const auto run = [](bool masked) {
    auto views = Photos(3);
    for (TrainView& view : views) {
      if (masked) view.pixel_weight = Buffer<float>::Full({kHeight, kWidth}, 1.f);
    }
    Trainer trainer(Options(60), kSeed, {0, 0, 0}, views, Start());
    for (int i = 0; i < 5; ++i) trainer.Step();
    return trainer.gaussians().Clone();
  };
  const Gaussians with = run(true), without = run(false);
  EXPECT_LT(MaxAbsError(with.sh, without.sh), 1e-3);
}

TEST(TrainerTest, NotFiniteLossNamesIterationAndView) {
  auto views = Photos(1);
  views[0].image[(3 * kWidth + 4) * 3] = std::nanf("");
  Trainer trainer(Options(), kSeed, {0, 0, 0}, views, Start());
  try {
    trainer.Step();
    ADD_FAILURE() << "a loss that is not a number was accepted";
  } catch (const RunError& e) {
    EXPECT_THAT(e.what(), HasSubstr("iteration 1 on photo0"));
  }
}

/// Device that gives the Gaussians NaN gradients in one iteration.
class FailingDevice final : public TrainDevice {
 public:
  FailingDevice(const TrainDeviceSetup& setup, int64_t fails_at)
      : device_(MakeTrainDevice(kCpu, setup)), at_(fails_at) {}

  Rasterizer& rasterizer() override { return device_->rasterizer(); }
  RenderTimings TimingsSoFar() const override { return device_->TimingsSoFar(); }
  std::unique_ptr<Rasterizer> NewRasterizer() const override { return device_->NewRasterizer(); }
  void RunParts(const Iteration& iteration, TrainedModel* model) override { device_->RunParts(iteration, model); }
  Densifier& densifier() override { return device_->densifier(); }
  TrainedModel Upload(const TrainedModel& host) override { return device_->Upload(host); }
  TrainedModel Download(const TrainedModel& model) const override { return device_->Download(model); }
  Buffer<float> OpacityFactors(const OpacityPerturbation& perturbation, int64_t n) override {
    return device_->OpacityFactors(perturbation, n);
  }
  RenderGrads LossOfView(const Iteration& iteration, const RenderOutput& out) override {
    RenderGrads grads = device_->LossOfView(iteration, out);
    if (iteration.number == at_) Flat(grads.image).setConstant(std::nanf(""));
    return grads;
  }
  void BackwardAndStep(const Iteration& iteration, const RenderGrads& upstream, TrainedModel* model) override {
    device_->BackwardAndStep(iteration, upstream, model);
  }
  void CapScales(TrainedModel* model) override { device_->CapScales(model); }
  void Refine(const Iteration& iteration, TrainedModel* model) override { device_->Refine(iteration, model); }
  LossReport Loss() override { return device_->Loss(); }
  void RestoreLoss(double smoothed) override { device_->RestoreLoss(smoothed); }
  ExposureState exposures() const override { return device_->exposures(); }
  void RestoreExposures(const ExposureState& state) override { device_->RestoreExposures(state); }

 private:
  std::unique_ptr<TrainDevice> device_;
  int64_t at_;
};

TEST(TrainerTest, AGradientThatIsNoNumberLeavesTheLastGoodCheckpoint) {
  for (const int64_t fails_at : {7, 25, 30, 39, 40}) {
    TempDir dir;
    Trainer trainer({Options(40), kSeed, {0, 0, 0}, Photos(2), Start()},
                    [&](const TrainDeviceSetup& setup) { return std::make_unique<FailingDevice>(setup, fails_at); });
    std::string error;
    try {
      trainer.Run({dir.path(), 10, {}}, Silent());
    } catch (const Diverged& diverged) {
      error = diverged.what();
    }
    const int64_t good = (fails_at - 1) / 10 * 10;
    if (fails_at == 40) {  // the last iteration moves nothing
      EXPECT_EQ(error, "");
      continue;
    }
    EXPECT_THAT(error, testing::AllOf(HasSubstr("training has diverged; check the poses"),
                                      HasSubstr(good == 0 ? "nothing had been saved"
                                                          : CheckpointPath(dir.path(), good).string() +
                                                                " was saved before that")));
    const auto newest = NewestCheckpoint(dir.path());
    ASSERT_EQ(newest.has_value(), good > 0);
    if (good == 0) continue;
    const Checkpoint checkpoint = ReadCheckpoint(*newest);
    EXPECT_EQ(checkpoint.iteration, good);
    checkpoint.gaussians.ForEach(
        [](const char* name, const Buffer<float>& values) { EXPECT_TRUE(Flat(values).allFinite()) << name; });
  }
}

/// Expects finite parameters after training on a degenerate scene.
void ExpectNumbers(std::vector<TrainView> views, const Gaussians& start) {
  Trainer trainer(Options(60), kSeed, {0, 0, 0}, std::move(views), start);
  trainer.Run({}, Silent());
  trainer.gaussians().ForEach(
      [](const char* name, const Buffer<float>& values) { EXPECT_TRUE(Flat(values).allFinite()) << name; });
}

TEST(TrainerTest, DegenerateScenesGiveNumbers) {
  {
    SCOPED_TRACE("all cameras are equal");
    std::vector<TrainView> views = Photos(3);
    for (TrainView& view : views) view.camera = views[0].camera;
    ExpectNumbers(views, Start());
  }
  {
    SCOPED_TRACE("all points in one plane");
    Gaussians start = Start();
    for (int64_t i = 0; i < start.size(); ++i) start.means[3 * i + 2] = 0;
    ExpectNumbers(Photos(3), start);
  }
  {
    SCOPED_TRACE("all points in one place");
    Gaussians start = Start();
    start.means.SetZero();
    ExpectNumbers(Photos(3), start);
  }
  {
    SCOPED_TRACE("one Gaussian");
    ExpectNumbers(Photos(3), Start(1));
  }
  {
    SCOPED_TRACE("none is visible");
    Gaussians start = Start();
    for (int64_t i = 0; i < start.size(); ++i) start.means[3 * i + 1] += 1e4f;
    ExpectNumbers(Photos(3), start);
  }
  {
    SCOPED_TRACE("all are dead");
    Gaussians start = Start();
    Flat(start.opacity_logits).setConstant(-15);
    ExpectNumbers(Photos(3), start);
  }
  {
    SCOPED_TRACE("images of one pixel");
    std::vector<TrainView> views = Photos(3);
    for (TrainView& view : views) {
      view.camera.width = view.camera.height = 1, view.camera.cx = view.camera.cy = 0.5;
      view.image = view.image.Rows(0, 1).Clone();
      view.image = Buffer<float>::From({1, 1, 3}, std::vector<float>{0.5f, 0.2f, 0.1f});
    }
    ExpectNumbers(views, Start());
  }
  {
    SCOPED_TRACE("sizes at the ends of what a float holds");
    Gaussians start = Start();
    Flat(start.log_scales).head(30).setConstant(-80);
    Flat(start.log_scales).segment(30, 30).setConstant(30);
    ExpectNumbers(Photos(3), start);
  }
  {
    SCOPED_TRACE("denormal numbers");
    Gaussians start = Start();
    const float tiny = std::numeric_limits<float>::denorm_min();
    Flat(start.means).head(60).setConstant(tiny);
    Flat(start.sh).setConstant(tiny);
    ExpectNumbers(Photos(3), start);
  }
}

TEST(TrainerTest, ReportsProgress) {
  Trainer trainer = MakeTrainer(Options(250));
  std::vector<int64_t> done;
  trainer.Run({}, [&](const Event& event) {
    if (const auto* step = std::get_if<StepDone>(&event)) {
      done.push_back(step->done);
      EXPECT_EQ(step->total, 250);
      EXPECT_EQ(step->stage, "train");
      EXPECT_THAT(step->detail, HasSubstr(" Gaussians"));
    }
  });
  EXPECT_GE(done.size(), 3u);
  EXPECT_EQ(done.back(), 250);
}

TEST(TrainerTest, ShowsEachIterationAndChangesNothing) {
  Trainer unseen = MakeTrainer(Options(40));
  unseen.Run({}, Silent());
  Trainer seen = MakeTrainer(Options(40));
  std::vector<int64_t> iterations;
  double seconds = 0, last_loss = 0;
  seen.Run({}, Silent(), [&](const TrainMoment& moment) {
    iterations.push_back(moment.iteration);
    EXPECT_EQ(moment.total, 40);
    EXPECT_GE(moment.seconds, seconds);
    EXPECT_GT(moment.gaussians.To(kCpu).Clone().size(), 0);
    seconds = moment.seconds, last_loss = moment.loss();
  });
  ASSERT_EQ(iterations.size(), 41u);
  EXPECT_EQ(iterations.front(), 0) << "before the first";
  EXPECT_EQ(iterations.back(), 40);
  EXPECT_GT(last_loss, 0);
  EXPECT_TRUE(SameBits(seen.gaussians(), unseen.gaussians()));
}

TEST(TrainerTest, OneViewpointIsWarnedOf) {
  Trainer trainer(Options(2), kSeed, {0, 0, 0}, Photos(1), Start());
  int warnings = 0;
  trainer.Run({}, [&](const Event& event) { warnings += std::holds_alternative<Warning>(event); });
  EXPECT_EQ(warnings, 1);
}

TEST(TrainerTest, RefusesWhatDoesNotFit) {
  EXPECT_THROW(Trainer(Options(), kSeed, {0, 0, 0}, {}, Start()), UsageError);
  EXPECT_THROW(Trainer(Options(), kSeed, {0, 0, 0}, Photos(2), Gaussians::Zeros(0)), UsageError);
  TrainOptions options = Options();
  options.ssim_weight = 2;
  EXPECT_THROW(Trainer(options, kSeed, {0, 0, 0}, Photos(2), Start()), UsageError);
  auto views = Photos(2);
  views[1].image = views[1].image.Rows(0, 5);
  EXPECT_THROW(Trainer(Options(), kSeed, {0, 0, 0}, views, Start()), ShapeError);
}

TEST(TrainerTest, RefusesCheckpointsOfAnotherRun) {
  Trainer trainer = MakeTrainer(Options());
  for (int i = 0; i < 10; ++i) trainer.Step();
  const Checkpoint good = trainer.MakeCheckpoint();
  EXPECT_THROW(MakeTrainer(Options(9)).Restore(good), InputError);
  Checkpoint bad = trainer.MakeCheckpoint();
  bad.sampler.photos = {17};
  EXPECT_THROW(MakeTrainer(Options()).Restore(bad), InputError);
  bad = trainer.MakeCheckpoint();
  bad.adam = Adam(3);
  EXPECT_THROW(MakeTrainer(Options()).Restore(bad), InputError);
  bad.adam = Adam(bad.gaussians.size(), ShMoments::kCompact);
  EXPECT_THAT(MessageOf<InputError>([&] { MakeTrainer(Options()).Restore(bad); }), HasSubstr("--set sh-moments"));

  bad = trainer.MakeCheckpoint();
  bad.options = {{"seed", 1}, {"iterations", 7000}};
  Trainer resumed = MakeTrainer(Options());
  resumed.Restore(bad);
  try {
    resumed.Run({"", 0, {{"seed", 2}, {"iterations", 7000}}}, Silent());
    ADD_FAILURE() << "other options were accepted";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("seed 1, not 2"));
  }
}

}  // namespace
}  // namespace oraclegs
