#include "oraclegs/train/rows.h"

#include <gtest/gtest.h>

#include "train/gaussian_fixtures.h"

namespace oraclegs {
namespace {

TEST(RowsTest, GrowthKeepsValuesAndStaysContiguous) {
  const Gaussians start = RandomGaussians(20, 1);
  Gaussians grown = Copy(start);
  for (int64_t rows = 21; rows < 200; rows += 7) {
    GrowRows(&grown, rows);
    grown.Check("test");
    ASSERT_EQ(grown.size(), rows);
    Gaussians head = grown;
    head.ForEach([](const char*, Buffer<float>& t) { t = t.narrow(0, 0, 20); });
    EXPECT_TRUE(SameBits(head, start));
  }
}

TEST(RowsTest, MostGrowthMovesNothing) {
  Buffer<float> t = Buffer<float>::Zeros({1000, 3});
  int moves = 0;
  for (int64_t rows = 1000; rows < 10000; rows += rows / 20) {
    const void* before = t.data_ptr();
    t = GrowRows(t, rows);
    moves += t.data_ptr() != before;
  }
  EXPECT_GE(moves, 1);
  EXPECT_LE(moves, 6);  // 1.5^6 > 10
}

TEST(RowsTest, NeverReadsBeyondItsStorage) {
  const Buffer<float> all = torch::arange(30, torch::kFloat).view({10, 3});
  const Buffer<float> middle = all.narrow(0, 2, 3);  // begins inside: no room of its own
  const Buffer<float> grown = GrowRows(middle, 5);
  EXPECT_NE(grown.data_ptr(), middle.data_ptr());
  EXPECT_TRUE(torch::equal(grown.narrow(0, 0, 3), middle));
}

TEST(RowsTest, CloneSharesNothing) {
  const Gaussians a = RandomGaussians(5, 1);
  Gaussians b = Clone(a);
  EXPECT_TRUE(SameBits(a, b));
  b.sh.SetZero();
  EXPECT_GT(a.sh.abs().sum().item<float>(), 0);
}

}  // namespace
}  // namespace oraclegs
