#include "oraclegs/experiments/confidence_check.h"

#include <gtest/gtest.h>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

TEST(ConfidenceCheck, SeparatesWhatOnePhotoSees) {
  ConfidenceCheck check;
  // Seen: tampered 0 and 102, honest 102 and 255. Of the four pairs three are in order and one is a tie.
  check.Add({{0, 102, 102, 255}, {255, 255, 0, 0}, {0, 0, 0, 0}, {0b001, 0b101, 0b100, 0}});
  // Unseen: the tampered pixel has more confidence than the honest one.
  check.Add({{51, 204}, {0, 255}, {255, 255}, {0, 0b010}});
  const TamperedConfidence found = check.Result();
  EXPECT_DOUBLE_EQ(*found.auroc, 3.5 / 4);
  EXPECT_DOUBLE_EQ(*found.auroc_void, 0);
  EXPECT_DOUBLE_EQ(*found.auroc_of_kind[0], 3.5 / 4);
  EXPECT_DOUBLE_EQ(*found.auroc_of_kind[2], 1.5 / 2) << "the pixel of 0 alone is of another kind";
  EXPECT_FALSE(found.auroc_of_kind[1]) << "no photo contradicts it";
  EXPECT_NEAR(*found.on_tampered, (0 + 0.4 + 0.8) / 3, 1e-6);
  EXPECT_NEAR(*found.on_honest, (0.4 + 1 + 0.2) / 3, 1e-6);
}

TEST(ConfidenceCheck, HasNoNumberWithoutPixels) {
  ConfidenceCheck check;
  check.Add({{10, 20}, {0, 0}, {0, 0}, {0, 0}});
  const TamperedConfidence found = check.Result();
  EXPECT_FALSE(found.auroc);
  EXPECT_FALSE(found.auroc_void);
  EXPECT_FALSE(found.on_tampered);
  EXPECT_TRUE(found.on_honest);
  EXPECT_THROW(check.Add({{1}, {0}, {0, 0}, {0}}), ShapeError);
}

}  // namespace
}  // namespace oraclegs
