#include "oraclegs/networks/seva/chunks.h"

#include "networks/seva/chunks_fixture.h"

namespace oraclegs::seva {
namespace {

TEST(SevaChunks, OfBothPassesMatchTheOfficialOnes) {
  const SafetensorsFile file = SamplingFixture();
  const ChunkProblem problem = GoldenChunkProblem(file);
  ExpectGoldenChunks(FirstPassChunks(problem), file, "gt-nearest");
  ExpectGoldenChunks(SecondPassChunks(problem), file, "nearest-gt");
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
  for (const auto& chunks : {FirstPassChunks(problem), SecondPassChunks(problem)}) {
    std::vector<int> made(problem.targets.size());
    for (const Chunk& chunk : chunks) {
      EXPECT_EQ(chunk.size(), 9u);
      for (const Slot& slot : chunk) {
        if (slot.kind == SlotKind::kTarget) ++made[static_cast<size_t>(slot.index)];
      }
    }
    EXPECT_EQ(made, std::vector<int>(made.size(), 1));
  }
}

TEST(SevaChunks, MostFrequentKeepsTheFirstOfEquals) {
  EXPECT_EQ(MostFrequent({5, 3, 3, 9, 5, 1}, 2), (std::vector<int64_t>{3, 5}));
  EXPECT_EQ(MostFrequent({7, 2, 4}, 2), (std::vector<int64_t>{2, 7}));
}

TEST(SevaChunks, SayWhichOptionDoesNotFit) {
  const auto message = [](int inputs, int64_t frames, auto* plan) -> std::string {
    ChunkProblem problem{Row(inputs), Row(40), {}, frames};
    for (int64_t i = 0; i < inputs; ++i) problem.inputs.push_back(i);
    try {
      plan(problem);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "planned";
  };
  EXPECT_EQ(message(21, 21, FirstPassChunks),
            "21 photos leave no room in chunks of 21 frames; --seva-frames must be at least 23");
  EXPECT_EQ(message(20, 21, SecondPassChunks),
            "20 photos leave no room in chunks of 21 frames; --seva-frames must be at least 22");
  EXPECT_EQ(message(3, 4, FirstPassChunks),
            "chunks of 4 frames have no room for photos, made frames and new ones; raise --seva-frames");
}

}  // namespace
}  // namespace oraclegs::seva
