#include "oraclegs/experiments/launch/make_launcher.h"

#include <gmock/gmock.h>

#include "support/errors.h"

namespace oraclegs {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

const DeviceSupport kNoGpu, kThreeGpus{3, true};

TEST(WorkersFor, IsOneOnACpu) {
  const LocalWorkers workers = WorkersFor({}, kNoGpu, "");
  EXPECT_EQ(workers.count, 1);
  EXPECT_THAT(workers.gpus, IsEmpty());
  EXPECT_EQ(WorkersFor({4, "cpu"}, kThreeGpus, "").count, 4);
  EXPECT_THAT(WorkersFor({4, "cpu"}, kThreeGpus, "").gpus, IsEmpty());
}

TEST(WorkersFor, IsOneForEachGpu) {
  const LocalWorkers workers = WorkersFor({{}, "cuda"}, kThreeGpus, "");
  EXPECT_EQ(workers.count, 3);
  EXPECT_THAT(workers.gpus, ElementsAre("0", "1", "2"));
  EXPECT_THAT(WorkersFor({{}, "cuda"}, kThreeGpus, "5, 6").gpus, ElementsAre("5", "6")) << "those that may be used";
  EXPECT_EQ(WorkersFor({6, "auto"}, kThreeGpus, "").count, 6);
}

TEST(WorkersFor, LeavesAChosenGpuAlone) {
  const LocalWorkers workers = WorkersFor({{}, "cuda:1"}, kThreeGpus, "");
  EXPECT_EQ(workers.count, 1);
  EXPECT_THAT(workers.gpus, IsEmpty());
}

TEST(MakeLauncher, MakesALocalOne) {
  EXPECT_NE(MakeLauncher(LauncherKind::kLocal, {1, "cpu"}), nullptr);
  EXPECT_NE(MessageOf<UsageError>([] { MakeLauncher(LauncherKind::kLocal, {1, "gpu"}); }), "");
}

}  // namespace
}  // namespace oraclegs
