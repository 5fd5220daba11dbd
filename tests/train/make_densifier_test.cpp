#include "oraclegs/train/make_densifier.h"

#include <gtest/gtest.h>

#include "train/small_scene.h"

namespace oraclegs {
namespace {

/// Gaussians after one refinement of a start with dead Gaussians.
Gaussians Refined(const TrainOptions& options, bool* adds_noise) {
  const LossPlan plan(options, Photos(2));
  auto rasterizer = MakeRasterizer(kCpu);
  const std::unique_ptr<Densifier> densifier = MakeMcmcDensifier({options, plan, rasterizer.get()});
  TrainedModel model{Start(), Adam(Start().size())};
  densifier->Begin(model.gaussians.size());
  *adds_noise = densifier->AddsNoise();
  Iteration iteration;
  iteration.seed = kSeed, iteration.number = 40, iteration.refines = true;
  densifier->Refine(iteration, &model);
  return model.gaussians;
}

TEST(McmcDensifier, MovesTheDeadAndGrows) {
  bool adds_noise = false;
  const Gaussians refined = Refined(Options(), &adds_noise);
  EXPECT_TRUE(adds_noise);
  EXPECT_EQ(refined.size(), 63) << "5 % more";
  EXPECT_GT(Flat(refined.opacity_logits).minCoeff(), -6);
}

}  // namespace
}  // namespace oraclegs
