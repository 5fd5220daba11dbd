#include "oraclegs/run/best_so_far.h"

#include "oraclegs/core/interrupt.h"
#include "oraclegs/gaussians/ply.h"
#include "oraclegs/run/reconstruct.h"
#include "oraclegs/run/stages.h"
#include "oraclegs/run/start.h"
#include "oraclegs/workspace/stage_records.h"
#include "run/proposing.h"

namespace oraclegs {
namespace {

using testing::Contains;
using testing::HasSubstr;

/// Interrupts a run when `stage` begins.
class BestSoFarTest : public ProposingTest {
 protected:
  void StopAt(const RunRequest& request, const std::string& stage) {
    EXPECT_THROW(Reconstruct(request,
                             [&](const Event& event) {
                               recorder.AsListener()(event);
                               const auto* started = std::get_if<StageStarted>(&event);
                               if (started != nullptr && started->stage == stage) RequestInterrupt(true);
                             }),
                 Interrupted);
    EXPECT_TRUE(InterruptRequested());
    RequestInterrupt(false);
  }
  ~BestSoFarTest() override { RequestInterrupt(false); }
};

TEST_F(BestSoFarTest, GrowsWithEachStopAndEndsWithTheResult) {
  RunRequest request = Request("growing");
  request.options.report.report = true;
  const WorkspacePaths paths(request.out);
  StopAt(request, "depth");  // photos this small have no sparse points
  EXPECT_FALSE(std::filesystem::exists(paths.point_cloud()));
  StopAt(request, "proxies");
  EXPECT_EQ(UnfinishedSplat(paths.root()), "dense points");
  EXPECT_GT(ReadIntactGaussianPly(paths.point_cloud()).gaussians.size(), 0);
  EXPECT_THAT(ReadFile(paths.report() / "run.json"), HasSubstr("\"unfinished\":\"dense points\""));
  EXPECT_FALSE(HasResults(paths)) << "other options may be given still";
  StopAt(request, "validate");
  EXPECT_EQ(UnfinishedSplat(paths.root()), "draft model");
  EXPECT_THAT(recorder.notes, Contains(HasSubstr("is the draft model, the best so far")));
  StopAt(request, "sfm");  // is read back, and shows less than what is there
  EXPECT_EQ(UnfinishedSplat(paths.root()), "draft model");
  StopAt(request, "train");  // before its first iteration
  EXPECT_EQ(UnfinishedSplat(paths.root()), "draft model");
  Reconstruct(request, Silent());
  EXPECT_EQ(UnfinishedSplat(paths.root()), "");
}

TEST_F(BestSoFarTest, LeavesNoRequestWhereNoneWas) {
  auto run = StartRun(Request("by_a_caller"), Silent());
  RunStage(&run, "depth");
  LeaveBestSoFar(&run);
  EXPECT_FALSE(InterruptRequested());
  EXPECT_EQ(UnfinishedSplat(run.workspace.root()), "dense points");
}

}  // namespace
}  // namespace oraclegs
