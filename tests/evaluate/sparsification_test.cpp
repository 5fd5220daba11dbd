#include "oraclegs/evaluate/sparsification.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "oraclegs/core/error.h"
#include "oraclegs/evaluate/rank_statistics.h"

namespace oraclegs {
namespace {

PixelErrors EqualErrors(const std::vector<float>& errors) {
  PixelErrors of{{}, errors, errors, errors};
  for (size_t i = 0; i < errors.size(); ++i) of.at.push_back(static_cast<int64_t>(i));
  return of;
}

std::vector<float> RisingErrors(int n) {
  std::vector<float> values;
  for (int i = 0; i < n; ++i) values.push_back(static_cast<float>(i) / static_cast<float>(n));
  return values;
}

TEST(SparsificationArea, OfTiesIsTheirMean) {
  const std::vector<float> error = {0.2f, 0.4f}, same = {1, 1};
  EXPECT_NEAR(SparsificationArea(error, same, RisingOrder(same)), 0.3, 1e-6);
  const std::vector<float> knows = {1, 0};  // the second leaves first
  EXPECT_NEAR(SparsificationArea(error, knows, RisingOrder(knows)), 0.25, 1e-6);
}

TEST(PublishedAuse, IsNothingForTheIdealOrder) {
  const std::vector<float> ramp = RisingErrors(1000);
  const PublishedAuse ause = PooledAuse({EqualErrors(ramp)}, {ramp});
  EXPECT_DOUBLE_EQ(ause.mae, 0);
  EXPECT_DOUBLE_EQ(ause.rmse, 0);
  EXPECT_DOUBLE_EQ(ause.dssim, 0);
}

TEST(PublishedAuse, OfTheReverseOrderOfARamp) {
  // Mean errors of a ramp on [0, 1] from which the share r is removed: (1 - r) / 2 in the ideal order, (1 + r) / 2 in
  // the reverse. The largest value is (1 + .99) / 2; the area of the difference r from 0 to .99 is .99^2 / 2.
  const std::vector<float> ramp = RisingErrors(10000);
  std::vector<float> doubt;
  for (const float e : ramp) doubt.push_back(1 - e);
  EXPECT_NEAR(PooledAuse({EqualErrors(ramp)}, {doubt}).mae, 0.99 * 0.99 / 2 / 0.995, 1e-3);
}

TEST(PublishedAuse, OfImagesIsTheMeanOfTheirs) {
  const std::vector<float> ramp = RisingErrors(200);
  std::vector<float> wrong;
  for (const float e : ramp) wrong.push_back(1 - e);
  const double worst = PooledAuse({EqualErrors(ramp)}, {wrong}).mae;
  EXPECT_NEAR(MeanAuse({EqualErrors(ramp), EqualErrors(ramp), EqualErrors({})}, {ramp, wrong, {}}).mae, worst / 2,
              1e-9);
  EXPECT_TRUE(std::isnan(MeanAuse({EqualErrors({})}, {{}}).rmse));
  EXPECT_TRUE(ToJson(PooledAuse({}, {}))["mae"].is_null());
  EXPECT_DOUBLE_EQ(PooledAuse({EqualErrors({0, 0, 0})}, {{1, 2, 3}}).mae, 0);  // no error at all
  EXPECT_THROW(PooledAuse({EqualErrors(ramp)}, {{1.f}}), ShapeError);
}

}  // namespace
}  // namespace oraclegs
