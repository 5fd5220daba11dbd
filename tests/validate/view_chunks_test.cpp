#include "oraclegs/validate/view_chunks.h"

#include <gmock/gmock.h>

#include "depth/surfaces.h"

namespace oraclegs {
namespace {

using testing::ElementsAre;
using testing::Pair;

std::vector<LoadedView> Views(int n) {
  std::vector<LoadedView> views;
  for (const Camera& camera : Arc(n, 8)) views.push_back({"p" + std::to_string(views.size()), camera, {}, {}});
  return views;
}

std::vector<Query> At(const std::vector<LoadedView>& views, const std::vector<int>& numbers, bool hold_out) {
  std::vector<Query> out;
  for (const int n : numbers) {
    out.push_back({{"t" + std::to_string(n), "warp", views[static_cast<size_t>(n)].camera, {}}});
    if (hold_out) out.back().held_out = n;
  }
  return out;
}

TEST(EvenRuns, AreFewAndEven) {
  EXPECT_THAT(EvenRuns(9, 4), ElementsAre(Pair(0, 3), Pair(3, 6), Pair(6, 9)));
  EXPECT_THAT(EvenRuns(8, 8), ElementsAre(Pair(0, 8)));
  EXPECT_THAT(EvenRuns(3, 1), ElementsAre(Pair(0, 1), Pair(1, 2), Pair(2, 3)));
  EXPECT_TRUE(EvenRuns(0, 4).empty());
}

TEST(ShuffledRuns, HoldEachNumberOnceInAnOrderOfTheSeed) {
  const auto runs = ShuffledRuns(9, 4, 7);
  ASSERT_EQ(runs.size(), 3u);
  std::vector<size_t> all;
  for (const auto& run : runs) {
    EXPECT_EQ(run.size(), 3u);
    all.insert(all.end(), run.begin(), run.end());
  }
  EXPECT_FALSE(std::is_sorted(all.begin(), all.end()));
  EXPECT_THAT(all, testing::UnorderedElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8));
  EXPECT_EQ(ShuffledRuns(9, 4, 7), runs);
  EXPECT_NE(ShuffledRuns(9, 4, 8), runs);
  EXPECT_TRUE(ShuffledRuns(0, 4, 7).empty());
}

TEST(PlanChunks, PutsTheNearestViewBeside) {
  const auto views = Views(9);
  const auto chunks = PlanChunks(At(views, {0, 1, 2, 6, 7, 8}, false), views, 3);
  ASSERT_EQ(chunks.size(), 2u);
  EXPECT_THAT(chunks[0].members, ElementsAre(0, 1, 2));
  EXPECT_EQ(chunks[0].reference, 1u);
  EXPECT_THAT(chunks[1].members, ElementsAre(3, 4, 5));
  EXPECT_EQ(chunks[1].reference, 7u);
}

TEST(PlanChunks, PutsNoHeldOutViewBesideItself) {
  const auto views = Views(6);
  const auto queries = At(views, {0, 1, 2, 3, 4, 5}, true);
  std::vector<size_t> all;
  for (const ViewChunk& chunk : PlanChunks(queries, views, 16)) {
    for (const size_t m : chunk.members) {
      EXPECT_NE(static_cast<size_t>(*queries[m].held_out), chunk.reference);
      all.push_back(m);
    }
  }
  EXPECT_THAT(all, ElementsAre(0, 1, 2, 3, 4, 5));  // halved, all six hold out all there is
}

TEST(PlanChunks, KeepsSourcesAndSizesApart) {
  auto views = Views(4);
  auto asked = At(views, {0, 1, 2, 3}, false);
  asked[1].proposal.source = "proxies";
  asked[3].proposal.camera.width = 50;
  views[0].camera.width = 50;
  const auto chunks = PlanChunks(asked, views, 8);
  ASSERT_EQ(chunks.size(), 3u);
  size_t members = 0;
  for (const ViewChunk& chunk : chunks) {
    members += chunk.members.size();
    for (const size_t m : chunk.members) EXPECT_EQ(asked[m].proposal.source, asked[chunk.members[0]].proposal.source);
    const bool narrow = asked[chunk.members[0]].proposal.camera.width == 50;
    EXPECT_EQ(narrow, views[chunk.reference].camera.width == 50);  // of its own size, where there is one
  }
  EXPECT_EQ(members, 4u);
}

TEST(PlanChunks, RefusesToHoldOutTheOnlyView) {
  const auto views = Views(1);
  EXPECT_THAT([&] { PlanChunks(At(views, {0}, true), views, 4); },
              testing::ThrowsMessage<InputError>(
                  testing::AllOf(testing::StartsWith("t0: VGGT has no view"), testing::HasSubstr("--oracle"))));
  EXPECT_EQ(PlanChunks(At(views, {0}, false), views, 4).size(), 1u);
}

}  // namespace
}  // namespace oraclegs
