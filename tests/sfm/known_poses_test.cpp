#include "oraclegs/sfm/known_poses.h"

#include <gtest/gtest.h>

#include "oraclegs/core/progress.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

TEST(TriangulateAtPoses, FailsWithoutADatabase) {
  const TempDir dir;
  const ColmapRunner colmap(dir.path(), Silent(), "sfm");
  try {
    TriangulateAtPoses(colmap, dir / "poses", dir / "made");
    ADD_FAILURE() << "there is nothing to triangulate";
  } catch (const ColmapFailure& failure) {
    EXPECT_EQ(failure.command, "point_triangulator");
  }
}

}  // namespace
}  // namespace oraclegs
