#include "networks/seva/chunks_fixture.h"
#include "oraclegs/networks/seva/plan.h"

namespace oraclegs::seva {
namespace {

/// The scene of the paper's settings: 12 input images, 50 targets, 68 frames on an orbit.
struct GoldenOracle {
  SafetensorsFile file = SamplingFixture();
  std::vector<View> inputs, targets, anchors = GoldenViews(file, "oracle.anchor_c2w");
  int64_t frames = file.Values<int64_t>("oracle.T").at(0);

  GoldenOracle() {
    const std::vector<View> all = GoldenViews(file, "oracle.all_c2w");
    for (const int64_t i : file.Values<int64_t>("oracle.train_ids")) inputs.push_back(all.at(static_cast<size_t>(i)));
    for (const int64_t i : file.Values<int64_t>("oracle.test_ids")) targets.push_back(all.at(static_cast<size_t>(i)));
  }
  ChunkProblem Problem(const std::vector<View>& sources, const std::vector<View>& wanted) const {
    ChunkProblem problem{sources, wanted, {}, frames};
    for (size_t i = 0; i < inputs.size(); ++i) problem.inputs.push_back(static_cast<int64_t>(i));
    return problem;
  }
};

TEST(SevaNearestChunks, ThePapersPassesMatchTheOfficialOnes) {
  const GoldenOracle golden;
  ExpectGoldenChunks(FirstPassChunks(golden.Problem(golden.inputs, golden.anchors)), golden.file, "oracle_pass1");
  ExpectGoldenChunks(SecondPassChunks(golden.Problem(golden.inputs, golden.targets)), golden.file, "oracle_onepass");
  std::vector<View> sources = golden.inputs;
  sources.insert(sources.end(), golden.anchors.begin(), golden.anchors.end());
  ExpectGoldenChunks(SecondPassChunks(golden.Problem(sources, golden.targets)), golden.file, "oracle_pass2");
}

TEST(SevaNearestChunks, ThePapersOrbitAndItsPlanMatchTheOfficialOnes) {
  const GoldenOracle golden;
  SevaOptions options;
  options.frames = static_cast<int>(golden.frames);
  const Plan plan = MakePlan(golden.inputs, golden.targets, options);
  ASSERT_EQ(static_cast<int64_t>(plan.anchors.size()), golden.file.Values<int64_t>("oracle.num_anchors").at(0));
  for (size_t i = 0; i < plan.anchors.size(); ++i) {
    const Eigen::Matrix4d difference =
        plan.anchors[i].world_from_camera.matrix() - golden.anchors[i].world_from_camera.matrix();
    EXPECT_LE(difference.cwiseAbs().maxCoeff(), 1e-3) << i;
  }
  const size_t second = golden.file.Get("chunk.oracle_pass2.codes").shape.at(0);
  ASSERT_EQ(plan.jobs.size(), 1 + second);
  EXPECT_EQ(plan.jobs.front().pass, 1);
  EXPECT_EQ(plan.jobs.back().pass, 2);
  EXPECT_EQ(plan.largest(), golden.frames);
}

TEST(SevaNearestChunks, ASourceWhoseTargetsAreCutLeadsTheNextChunkAgain) {
  const ChunkProblem problem{Row(2), Row(7, 0.9), {}, 5};
  const std::vector<Chunk> chunks = SecondPassChunks(problem);
  EXPECT_EQ(Codes(chunks), (std::vector<int64_t>{1001, 0, 1, 2, 3, 1001, 4, 5, 6, -1}));
}

}  // namespace
}  // namespace oraclegs::seva
