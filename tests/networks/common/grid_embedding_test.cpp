#include "oraclegs/networks/common/grid_embedding.h"

#include <cmath>

#include "networks/golden_tensors.h"

namespace oraclegs {
namespace {

TEST(GridEmbedding, FollowsItsFormula) {
  const double aspect = 1.5, diagonal = std::sqrt(aspect * aspect + 1);
  const Tensor e = GridEmbedding(8, 3, 5, aspect);
  ASSERT_EQ(e.sizes(), at::IntArrayRef({8, 3, 5}));
  const double x = aspect / diagonal * 4 / 5 * 0.5, y = -1 / diagonal * 2 / 3;  // of column 3 and of row 0
  const double slow = 0.1;                                                      // 100^(-1/2)
  const std::vector<double> expected = {std::sin(x), std::sin(x * slow), std::cos(x), std::cos(x * slow),
                                        std::sin(y), std::sin(y * slow), std::cos(y), std::cos(y * slow)};
  EXPECT_LT(MaxAbsError(e.select(2, 3).select(1, 0), torch::tensor(expected, torch::kDouble)), 1e-7);
}

TEST(GridEmbedding, ASinglePixelIsInTheMiddle) {
  const Tensor e = GridEmbedding(4, 1, 1, 2).flatten();
  EXPECT_TRUE(torch::equal(e, torch::tensor({0.f, 1.f, 0.f, 1.f})));
}

TEST(GridEmbedding, RefusesOddChannels) {
  EXPECT_THROW(GridEmbedding(6, 2, 2, 1), ShapeError);
  EXPECT_THROW(GridEmbedding(0, 2, 2, 1), ShapeError);
  EXPECT_THROW(GridEmbedding(4, 0, 2, 1), ShapeError);
}

}  // namespace
}  // namespace oraclegs
