#include "oraclegs/core/shape.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

TEST(Shape, CountsEntriesAndRows) {
  EXPECT_EQ((Shape{4, 3, 2}).count(), 24);
  EXPECT_EQ((Shape{4, 3, 2}).row(), 6);
  EXPECT_EQ(Shape{}.count(), 1);
  EXPECT_EQ((Shape{0, 3}).count(), 0);
  EXPECT_EQ((Shape{7}).row(), 1);
}

TEST(Shape, IndexesFromBothEnds) {
  const Shape shape{4, 3, 2};
  EXPECT_EQ(shape[0], 4);
  EXPECT_EQ(shape[-1], 2);
  EXPECT_THROW(shape[3], ShapeError);
  EXPECT_THROW(shape[-4], ShapeError);
}

TEST(Shape, ComparesSizesAndDimensions) {
  EXPECT_EQ((Shape{2, 3}), (Shape{2, 3}));
  EXPECT_NE((Shape{2, 3}), (Shape{3, 2}));
  EXPECT_NE((Shape{2}), (Shape{2, 0}));
}

TEST(Shape, ReplacesTheFirstSize) {
  EXPECT_EQ((Shape{2, 3}).WithRows(5), (Shape{5, 3}));
  EXPECT_THROW(Shape{}.WithRows(1), ShapeError);
}

TEST(Shape, RefusesNegativeSizesAndTooManyDimensions) {
  EXPECT_THROW((Shape{2, -1}), ShapeError);
  EXPECT_THROW(Shape(std::vector<int64_t>(7, 1)), ShapeError);
}

TEST(Shape, PrintsItsSizes) { EXPECT_EQ((Shape{480, 640, 3}).Text(), "[480, 640, 3]"); }

}  // namespace
}  // namespace oraclegs
