#include "oraclegs/networks/common/rope.h"

#include <cmath>

#include "networks/golden_tensors.h"

namespace oraclegs {
namespace {

TEST(Rope, RotatesPairsByTheirFrequency) {
  // A width of 8: two frequencies for each axis, 1 and 1/10. The token of patch (1, 0) is at y = 2, x = 1.
  const RopeTable table = MakeRopeTable({1, 2, 1}, 8, 100);
  Tensor t = torch::zeros({1, 1, 3, 8});
  t[0][0][2][0] = 1;  // y, first of the pair, frequency 0
  t[0][0][2][7] = 1;  // x, second of the pair, frequency 1
  const Tensor r = Rotate(table, t)[0][0][2];
  const double y_angle = 2, x_angle = 0.1;
  const std::vector<double> expected = {std::cos(y_angle),  0, std::sin(y_angle), 0, 0,
                                        -std::sin(x_angle), 0, std::cos(x_angle)};
  EXPECT_LT(MaxAbsError(r, torch::tensor(expected, torch::kDouble)), 1e-6);
}

TEST(Rope, SpecialTokensStay) {
  const RopeTable table = MakeRopeTable({2, 1, 2}, 4, 100);
  const Tensor t = torch::rand({2, 3, 4, 4});
  const Tensor r = Rotate(table, t);
  EXPECT_TRUE(torch::equal(r.slice(2, 0, 2), t.slice(2, 0, 2)));
  EXPECT_GT(MaxAbsError(r.slice(2, 2), t.slice(2, 2)), 0.01);
}

TEST(Rope, ProductsDependOnTheDifferenceOfPositions) {
  const RopeTable table = MakeRopeTable({0, 5, 5}, 16, 100);
  const Tensor q = torch::rand({16}).expand({1, 1, 25, 16}), k = torch::rand({16}).expand({1, 1, 25, 16});
  const Tensor scores = at::matmul(Rotate(table, q)[0][0], Rotate(table, k)[0][0].t());
  EXPECT_NEAR(scores[0][7].item<double>(), scores[11][18].item<double>(), 1e-5);  // one down, two to the right
  EXPECT_GT(std::abs(scores[0][7].item<double>() - scores[0][8].item<double>()), 1e-4);
}

TEST(Rope, ViewsRepeatTheTable) {
  const RopeTable table = MakeRopeTable({1, 2, 2}, 8, 100), twice = Repeat(table, 2);
  const Tensor t = torch::rand({1, 2, 5, 8});
  const Tensor both = Rotate(twice, at::cat({t, t}, 2));
  EXPECT_TRUE(torch::equal(both.slice(2, 5), Rotate(table, t)));
}

TEST(Rope, OddWidthsAreRefused) {
  EXPECT_THROW(MakeRopeTable({1, 2, 2}, 6, 100), ShapeError);
  EXPECT_THROW(MakeRopeTable({1, 2, 2}, 0, 100), ShapeError);
}

}  // namespace
}  // namespace oraclegs
