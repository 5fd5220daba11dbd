#pragma once
// The chunks of tests/golden/seva_sampling, and ours in the same code.

#include "networks/seva/sampling_fixture.h"
#include "oraclegs/networks/seva/chunks.h"

namespace oraclegs::seva {

/// Codes of the slots: -1 empty, 1000 + i conditioning view i, j target j.
inline std::vector<int64_t> Codes(const std::vector<Chunk>& chunks) {
  std::vector<int64_t> codes;
  for (const Chunk& chunk : chunks) {
    for (const Slot& slot : chunk) {
      if (slot.kind == SlotKind::kEmpty) codes.push_back(-1);
      if (slot.kind == SlotKind::kGiven) codes.push_back(1000 + slot.index);
      if (slot.kind == SlotKind::kTarget) codes.push_back(slot.index);
    }
  }
  return codes;
}

/// For each place after padding: its index among the chunk's views of this kind, -1 for another kind.
inline std::vector<int64_t> Places(const std::vector<Chunk>& chunks, SlotKind kind) {
  std::vector<int64_t> places;
  for (const Chunk& chunk : chunks) {
    const Chunk padded = Padded(chunk);
    int64_t seen = 0;
    for (size_t i = 0; i < padded.size(); ++i) {
      if (padded[i].kind == kind && chunk[i].kind == kind) ++seen;
      places.push_back(padded[i].kind == kind ? seen - 1 : -1);
    }
  }
  return places;
}

inline void ExpectGoldenChunks(const std::vector<Chunk>& chunks, const SafetensorsFile& file, const std::string& name) {
  EXPECT_EQ(Codes(chunks), file.Values<int64_t>("chunk." + name + ".codes")) << name;
  EXPECT_EQ(Places(chunks, SlotKind::kGiven), file.Values<int64_t>("chunk." + name + ".input_maps")) << name;
  EXPECT_EQ(Places(chunks, SlotKind::kTarget), file.Values<int64_t>("chunk." + name + ".test_maps")) << name;
}

/// All conditioning views are input images.
inline ChunkProblem GoldenChunkProblem(const SafetensorsFile& file) {
  ChunkProblem problem;
  problem.sources = GoldenViews(file, "chunk.input_c2w");
  problem.targets = GoldenViews(file, "chunk.test_c2w");
  for (size_t i = 0; i < problem.sources.size(); ++i) problem.inputs.push_back(static_cast<int64_t>(i));
  problem.frames = file.Values<int64_t>("chunk.T").at(0);
  return problem;
}

/// `count` cameras in a row, one unit apart, the first at `start`.
inline std::vector<View> Row(int count, double start = 0) {
  std::vector<View> views(static_cast<size_t>(count));
  for (int i = 0; i < count; ++i) views[static_cast<size_t>(i)].world_from_camera.translation().x() = start + i;
  return views;
}

}  // namespace oraclegs::seva
