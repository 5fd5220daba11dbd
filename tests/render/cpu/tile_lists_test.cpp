#include "oraclegs/render/cpu/tile_lists.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "oraclegs/core/parallel.h"
#include "render/cpu/splats.h"

namespace oraclegs {
namespace {

constexpr int kColumns = 6, kRows = 5;

struct Input {
  std::vector<cpu::LineSplat> splats;
  std::vector<TileRect> rects;
};

/// Splats of which many share a depth and a third is not visible.
Input MakeInput(int64_t n) {
  Rng rng(5, RandomStream::kInitialPoints);
  Input in;
  for (int64_t i = 0; i < n; ++i) {
    cpu::LineSplat s = RandomSplat(&rng, kColumns * kTile, kRows * kTile);
    s.depth = std::round(s.depth * 20) / 20 + 0.25f;
    in.splats.push_back(s);
    in.rects.push_back(i % 3 == 0 ? TileRect{} : TileRect{0, 0, kColumns, kRows});
  }
  return in;
}

TEST(TileLists, SortsByDepthAndIndex) {
  const Input in = MakeInput(9000);
  cpu::TileLists lists;
  lists.Build(in.splats.data(), in.rects.data(), 9000, kColumns, kRows);
  std::map<uint32_t, int64_t> pairs_of;
  std::map<uint32_t, std::pair<uint32_t, int>> place_of;  // Gaussian and tile of a pair
  for (int tile = 0; tile < kColumns * kRows; ++tile) {
    for (int64_t i = lists.tile_begin.data()[tile]; i < lists.tile_begin.data()[tile + 1]; ++i) {
      const uint32_t id = lists.entries.data()[i].id;
      ++pairs_of[id];
      place_of[lists.entries.data()[i].pair] = {id, tile};
      if (i == lists.tile_begin.data()[tile]) continue;
      const uint32_t before = lists.entries.data()[i - 1].id;
      const auto key = [&](uint32_t k) { return std::pair(in.splats[k].depth, k); };
      EXPECT_LT(key(before), key(id)) << "tile " << tile;
    }
  }
  EXPECT_EQ(lists.tile_begin.data()[kColumns * kRows], lists.pairs);
  EXPECT_EQ(lists.visible, static_cast<int64_t>(pairs_of.size()));
  for (uint32_t id = 0; id < 9000; ++id) {
    const cpu::PairRange range = lists.ranges.data()[id];
    EXPECT_EQ(range.count, pairs_of.contains(id) ? pairs_of[id] : 0);
    for (uint32_t j = range.begin; j < range.begin + range.count; ++j) {
      EXPECT_LT(j, lists.pair_numbers);
      EXPECT_EQ(place_of.at(j), std::pair(id, static_cast<int>(lists.pair_tile.data()[j])));
    }
  }
}

TEST(TileLists, IsTheSameForAnyNumberOfThreads) {
  const Input in = MakeInput(20000);
  SetNumThreads(1);
  cpu::TileLists one;
  one.Build(in.splats.data(), in.rects.data(), 20000, kColumns, kRows);
  SetNumThreads(5);
  cpu::TileLists five;
  five.Build(in.splats.data(), in.rects.data(), 20000, kColumns, kRows);
  SetNumThreads(0);
  ASSERT_EQ(one.pairs, five.pairs);
  for (int tile = 0; tile <= kColumns * kRows; ++tile) {
    EXPECT_EQ(one.tile_begin.data()[tile], five.tile_begin.data()[tile]);
  }
  for (int64_t i = 0; i < one.pairs; ++i) {
    ASSERT_EQ(one.entries.data()[i].id, five.entries.data()[i].id);
    ASSERT_EQ(one.entries.data()[i].mask, five.entries.data()[i].mask);
  }
}

TEST(TileLists, NothingVisible) {
  const Input in = MakeInput(1);
  cpu::TileLists lists;
  lists.Build(in.splats.data(), in.rects.data(), 1, kColumns, kRows);
  EXPECT_EQ(lists.pairs, 0);
  EXPECT_EQ(lists.visible, 0);
}

}  // namespace
}  // namespace oraclegs
