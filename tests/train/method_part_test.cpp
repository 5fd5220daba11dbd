#include "oraclegs/train/method_part.h"

#include <gtest/gtest.h>

#include <numeric>

#include "oraclegs/train/densify.h"
#include "render/scenes.h"

namespace oraclegs {
namespace {

/// Drops the last Gaussians, if any, and adds a loss and its gradient.
class DroppingPart : public MethodPart {
 public:
  DroppingPart(int64_t dropped, double loss) : dropped_(dropped), loss_(loss) {}

  void Remove(const Iteration&, TrainedModel* model) override {
    if (dropped_ == 0) return;
    std::vector<int64_t> rows(static_cast<size_t>(model->gaussians.size() - dropped_));
    std::iota(rows.begin(), rows.end(), 0);
    KeepRows(rows, &model->gaussians, &model->adam);
  }
  double BeforeView(const Iteration&, TrainedModel*, PartGradients* gradients) override {
    gradients->push_back(&gradient_);
    return loss_;
  }

 private:
  int64_t dropped_;
  double loss_;
  Gaussians gradient_;
};

/// Remembers for how many Gaussians it began.
class CountingDensifier : public Densifier {
 public:
  void Refine(const Iteration&, TrainedModel*) override {}
  void Begin(int64_t gaussians) override { begun.push_back(gaussians); }
  std::vector<int64_t> begun;
};

TrainedModel ModelOf(int64_t n) {
  Gaussians gaussians = RandomGaussians(n, 0.1, 1);
  Adam adam(n, TrainOptions().sh_moments);
  return {std::move(gaussians), std::move(adam)};
}

TEST(RunParts, SumsLossesAndCollectsGradients) {
  const MethodParts parts{std::make_shared<DroppingPart>(0, 0.5), std::make_shared<DroppingPart>(0, 0.25)};
  TrainedModel model = ModelOf(8);
  CountingDensifier densifier;
  PartGradients gradients;
  EXPECT_EQ(RunParts(parts, {}, &densifier, &model, &gradients), 0.75);
  EXPECT_EQ(gradients.size(), 2u);
  EXPECT_TRUE(densifier.begun.empty()) << "no Gaussian went, so the densifier keeps its state";
}

TEST(RunParts, BeginsTheDensifierAnewOnceAllRemovalsAreDone) {
  const MethodParts parts{std::make_shared<DroppingPart>(3, 0), std::make_shared<DroppingPart>(1, 0)};
  TrainedModel model = ModelOf(8);
  CountingDensifier densifier;
  PartGradients gradients;
  RunParts(parts, {}, &densifier, &model, &gradients);
  EXPECT_EQ(model.gaussians.size(), 4);
  EXPECT_EQ(densifier.begun, std::vector<int64_t>{4});
}

}  // namespace
}  // namespace oraclegs
