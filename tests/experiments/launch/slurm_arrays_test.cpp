#include "oraclegs/experiments/launch/slurm_arrays.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace oraclegs {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(SlurmArrays, HoldAllThatWaitsWithoutALimit) {
  const SlurmArrays arrays = PlanSlurmArrays(2500, 7, 0);
  EXPECT_THAT(arrays.sizes, ElementsAre(1000, 1000, 500));
  EXPECT_EQ(arrays.throttle, 0u);
}

TEST(SlurmArrays, ShareTheLimit) {
  const SlurmArrays arrays = PlanSlurmArrays(1500, 0, 9);
  EXPECT_THAT(arrays.sizes, ElementsAre(1000, 500));
  EXPECT_EQ(arrays.throttle, 4u);
}

TEST(SlurmArrays, AreNoMoreThanTheLimit) {
  const SlurmArrays arrays = PlanSlurmArrays(3500, 0, 2);
  EXPECT_THAT(arrays.sizes, ElementsAre(1000, 1000)) << "a third would run one more";
  EXPECT_EQ(arrays.throttle, 1u);
}

TEST(SlurmArrays, WaitForRoom) {
  EXPECT_THAT(PlanSlurmArrays(10, 3, 4).sizes, ElementsAre(1));
  EXPECT_THAT(PlanSlurmArrays(10, 5, 4).sizes, IsEmpty());
  EXPECT_THAT(PlanSlurmArrays(0, 0, 4).sizes, IsEmpty());
}

}  // namespace
}  // namespace oraclegs
