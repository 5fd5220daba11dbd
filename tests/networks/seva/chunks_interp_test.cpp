#include "networks/seva/chunks_fixture.h"

namespace oraclegs::seva {
namespace {

TEST(SevaIntervalChunks, BetweenImagesMatchesTheOfficialOne) {
  const SafetensorsFile file = SamplingFixture();
  ChunkProblem problem = GoldenChunkProblem(file);
  problem.frames = file.Values<int64_t>("chunk.interp.T").at(0);
  ExpectGoldenChunks(PlanChunks(problem, Chunking::kInterp), file, "interp");
}

TEST(SevaIntervalChunks, BetweenMadeFramesMatchesTheOfficialOne) {
  const SafetensorsFile file = SamplingFixture();
  ChunkProblem problem = GoldenChunkProblem(file);
  problem.sources = GoldenViews(file, "chunk.trajvid_source_c2w");
  problem.source_orders = file.Values<double>("chunk.trajvid_source_ords");
  problem.target_orders = file.Values<double>("chunk.trajvid_test_ords");
  problem.time_line = TimeLine::kWithoutInputs;
  problem.frames = file.Values<int64_t>("chunk.trajvid_interp.T").at(0);
  ExpectGoldenChunks(PlanChunks(problem, Chunking::kInterp), file, "trajvid_interp");
  problem.frames = file.Values<int64_t>("chunk.trajvid_interp_gt.T").at(0);
  ExpectGoldenChunks(PlanChunks(problem, Chunking::kInterpGt), file, "trajvid_interp_gt");
}

TEST(SevaIntervalChunks, SayWhatDoesNotFit) {
  ChunkProblem problem{Row(2), Row(9), {0, 1}, 6, {0, 20}, {1, 2, 3, 4, 5, 6, 7, 8, 9}};
  EXPECT_THROW(PlanChunks(problem, Chunking::kInterp), UsageError);
  problem.time_line = TimeLine::kWithoutInputs;
  try {
    PlanChunks(problem, Chunking::kInterp);
    FAIL() << "planned";
  } catch (const UsageError& error) {
    EXPECT_STREQ(error.what(), "interp needs frames made in a first pass; set --seva-passes 2");
  }
  problem.source_orders.pop_back();
  EXPECT_THROW(PlanChunks(problem, Chunking::kInterp), ShapeError);
}

}  // namespace
}  // namespace oraclegs::seva
