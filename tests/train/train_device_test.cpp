#include "oraclegs/train/train_device.h"

#include <gtest/gtest.h>

#include "support/buffers.h"
#include "train/gaussian_fixtures.h"

namespace oraclegs {
namespace {

TEST(OnHost, GivesTheModelItselfOnACpu) {
  TrainedModel model{RandomGaussians(4, 1), Adam(4)};
  const float* means = model.gaussians.means.data();
  OnHost(&model, [&](TrainedModel* host) {
    EXPECT_EQ(host, &model);
    host->gaussians.means[0] = 7;
  });
  EXPECT_EQ(model.gaussians.means.data(), means);
  EXPECT_EQ(model.gaussians.means[0], 7);
}

TEST(KeepRows, KeepsParametersAndMomentsInTheirOrder) {
  const Gaussians before = RandomGaussians(4, 1);
  Gaussians gaussians = before.Clone();
  Adam adam(4, ShMoments::kHalf);
  adam.sh_m[3 * kShFloats] = 5;
  KeepRows({3, 1}, &gaussians, &adam);
  ASSERT_EQ(gaussians.size(), 2);
  EXPECT_TRUE(Equal(gaussians.quats.Rows(0, 1), before.quats.Rows(3, 4)));
  EXPECT_TRUE(Equal(gaussians.sh.Rows(1, 2), before.sh.Rows(1, 2)));
  EXPECT_EQ(adam.size(), 2);
  EXPECT_EQ(adam.sh_m[0], 5);
}

}  // namespace
}  // namespace oraclegs
