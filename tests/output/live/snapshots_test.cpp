#include "oraclegs/output/live/snapshots.h"

#include <gtest/gtest.h>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/formats/splat.h"
#include "support/buffers.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

TEST(SnapshotClock, TheFirstIsDueAtOnceAndCheapOnesEveryThreeSeconds) {
  SnapshotClock clock;
  EXPECT_TRUE(clock.IsDue(0));
  clock.Took(0.1, 0.01);
  EXPECT_FALSE(clock.IsDue(3));
  EXPECT_TRUE(clock.IsDue(3.2));
}

TEST(SnapshotClock, DearOnesAreAtMostAFiftieth) {
  SnapshotClock clock;
  clock.Took(10, 2);
  EXPECT_FALSE(clock.IsDue(109));
  EXPECT_TRUE(clock.IsDue(110));
}

TEST(WriteSnapshot, WritesASplat) {
  TempDir dir;
  Gaussians gaussians = Gaussians::Zeros(7);
  Flat(gaussians.quats).setConstant(0.5f);
  gaussians.means[20] = 3;
  EXPECT_GE(WriteSnapshot(dir / "a.splat", gaussians), 0);
  EXPECT_EQ(ReadFile(dir / "a.splat"), EncodeSplat(gaussians));
  EXPECT_THROW(WriteSnapshot(dir / "missing" / "a.splat", gaussians), RunError);
}

}  // namespace
}  // namespace oraclegs
