#include "oraclegs/networks/seva_size.h"

#include <gtest/gtest.h>

#include "oraclegs/core/error.h"

namespace oraclegs::seva {
namespace {

TEST(SevaSize, WorkingSizesAreMultiplesOf64) {
  const Size square = WorkingSize({800, 800}, 576), wide = WorkingSize({1297, 840}, 576);
  EXPECT_EQ(square.width, 576);
  EXPECT_EQ(square.height, 576);
  EXPECT_EQ(wide.width, 896);
  EXPECT_EQ(wide.height, 576);
  EXPECT_EQ(WorkingSize({840, 1297}, 576).height, 896);
  EXPECT_EQ(WorkingSize({50, 50}, 10).width, 64);
}

TEST(SevaSize, OfATargetIsItsFrameInTheWorkingImage) {
  const auto of = [](Size target) {
    const Size size = GeneratedSize(target, 576);
    return std::pair(size.width, size.height);
  };
  EXPECT_EQ(of({1237, 822}), std::pair(int64_t{867}, int64_t{576}));
  EXPECT_EQ(of({400, 400}), std::pair(int64_t{576}, int64_t{576}));
  EXPECT_EQ(of({822, 1237}), std::pair(int64_t{576}, int64_t{867}));
  EXPECT_THROW(of({0, 400}), ShapeError);
}

}  // namespace
}  // namespace oraclegs::seva
