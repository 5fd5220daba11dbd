#include "oraclegs/networks/seva/chunks.h"

#include "networks/seva/chunks_fixture.h"

namespace oraclegs {
namespace {

TEST(SevaChunks, EveryStrategyOfPhotographsMatchesTheOfficialOne) {
  const SafetensorsFile file = SamplingFixture();
  const ChunkProblem problem = GoldenChunkProblem(file);
  for (const std::string name : {"gt", "gt-nearest", "gt-ltr", "nearest", "nearest-gt", "nearest-2"}) {
    ExpectGoldenChunks(PlanChunks(problem, name), file, name);
  }
}

TEST(SevaChunks, NearestViewsAreTheOfficialOnes) {
  const SafetensorsFile file = SamplingFixture();
  const ChunkProblem problem = GoldenChunkProblem(file);
  const std::vector<int64_t> by_rotation = file.Values<int64_t>("chunk.nearest_rotation");
  const std::vector<int64_t> by_distance = file.Values<int64_t>("chunk.nearest_translation");
  for (size_t t = 0; t < problem.targets.size(); ++t) {
    EXPECT_EQ(NearestByRotation(problem.targets[t], problem.sources), by_rotation.at(t));
    EXPECT_EQ(NearestByDistance(problem.targets[t], problem.sources), by_distance.at(t));
  }
}

TEST(SevaChunks, EveryTargetIsMadeOnce) {
  ChunkProblem problem{Row(3), Row(29, -4.25), {0, 1, 2}, 9};
  for (const std::string name : {"gt", "gt-nearest", "gt-ltr", "nearest", "nearest-gt", "nearest-3"}) {
    std::vector<int> made(problem.targets.size());
    for (const SevaChunk& chunk : PlanChunks(problem, name)) {
      EXPECT_EQ(chunk.size(), 9u);
      for (const SevaSlot& slot : chunk) {
        if (slot.kind == SevaSlotKind::kTarget) ++made[static_cast<size_t>(slot.index)];
      }
    }
    EXPECT_EQ(made, std::vector<int>(made.size(), 1)) << name;
  }
}

TEST(SevaChunks, MostFrequentKeepsTheFirstOfEquals) {
  EXPECT_EQ(MostFrequent({5, 3, 3, 9, 5, 1}, 2), (std::vector<int64_t>{3, 5}));
  EXPECT_EQ(MostFrequent({7, 2, 4}, 2), (std::vector<int64_t>{2, 7}));
}

TEST(SevaChunks, SayWhichOptionDoesNotFit) {
  const auto message = [](int photographs, int64_t frames, const std::string& strategy) -> std::string {
    ChunkProblem problem{Row(photographs), Row(40), {}, frames};
    for (int64_t i = 0; i < photographs; ++i) problem.photographs.push_back(i);
    try {
      PlanChunks(problem, strategy);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "planned";
  };
  EXPECT_EQ(message(21, 21, "gt"),
            "21 photographs leave no room in chunks of 21 frames; --seva-frames must be at least 23");
  EXPECT_EQ(message(20, 21, "nearest-gt"),
            "20 photographs leave no room in chunks of 21 frames; --seva-frames must be at least 22");
  EXPECT_EQ(message(3, 4, "gt-ltr"),
            "chunks of 4 frames have no room for photographs, made frames and new ones; raise --seva-frames");
  EXPECT_EQ(message(3, 5, "nearest-5"),
            "nearest-5 leaves no room in chunks of 5 frames; --seva-frames must be at least 6");
  EXPECT_THAT(message(3, 9, "closest"), testing::HasSubstr("'closest' is no way to choose frames"));
  EXPECT_THAT(message(3, 9, "nearest-2x"), testing::HasSubstr("is no way to choose frames"));
}

}  // namespace
}  // namespace oraclegs
