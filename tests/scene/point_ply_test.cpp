#include "oraclegs/scene/point_ply.h"

#include <gtest/gtest.h>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

TEST(PointPly, HoldsPositionsAndColors) {
  const TempDir temp;
  WritePointPly(temp / "points.ply", {{{1, -2.5, 1e-7}, {255, 0, 7}, {}}, {{0, 0, 3}, {1, 2, 3}, {0, 1}}});
  EXPECT_EQ(ReadFile(temp / "points.ply"),
            "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
            "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
            "1 -2.5 1e-07 255 0 7\n0 0 3 1 2 3\n");
}

TEST(PointPly, NamesThePlaceThatCannotBeWritten) {
  const TempDir temp;
  WriteText(temp / "file", "no folder");
  EXPECT_THROW(WritePointPly(temp / "file" / "points.ply", {}), RunError);
}

}  // namespace
}  // namespace oraclegs
