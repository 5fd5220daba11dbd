#include "oraclegs/validate/view_chunks.h"

#include <gmock/gmock.h>

#include "depth/surfaces.h"

namespace oraclegs {
namespace {

using testing::ElementsAre;
using testing::Pair;

std::vector<LoadedView> Photos(int n) {
  std::vector<LoadedView> photos;
  for (const Camera& camera : Arc(n, 8)) photos.push_back({"p" + std::to_string(photos.size()), camera, {}, {}});
  return photos;
}

std::vector<HiddenPhotograph> At(const std::vector<LoadedView>& photos, const std::vector<int>& numbers, int hide) {
  std::vector<HiddenPhotograph> out;
  for (const int n : numbers) {
    out.push_back({hide != 0 ? n : -1, {"t" + std::to_string(n), "warp", photos[static_cast<size_t>(n)].camera, {}}});
  }
  return out;
}

TEST(EvenRuns, AreFewAndEven) {
  EXPECT_THAT(EvenRuns(9, 4), ElementsAre(Pair(0, 3), Pair(3, 6), Pair(6, 9)));
  EXPECT_THAT(EvenRuns(8, 8), ElementsAre(Pair(0, 8)));
  EXPECT_THAT(EvenRuns(3, 1), ElementsAre(Pair(0, 1), Pair(1, 2), Pair(2, 3)));
  EXPECT_TRUE(EvenRuns(0, 4).empty());
}

TEST(PlanChunks, TheNearestPhotographStandsBeside) {
  const auto photos = Photos(9);
  const auto chunks = PlanChunks(At(photos, {0, 1, 2, 6, 7, 8}, 0), photos, 3);
  ASSERT_EQ(chunks.size(), 2u);
  EXPECT_THAT(chunks[0].members, ElementsAre(0, 1, 2));
  EXPECT_EQ(chunks[0].reference, 1u);
  EXPECT_THAT(chunks[1].members, ElementsAre(3, 4, 5));
  EXPECT_EQ(chunks[1].reference, 7u);
}

TEST(PlanChunks, NoHiddenPhotographStandsBesideItself) {
  const auto photos = Photos(6);
  const auto hidden = At(photos, {0, 1, 2, 3, 4, 5}, 1);
  std::vector<size_t> all;
  for (const ViewChunk& chunk : PlanChunks(hidden, photos, 16)) {
    for (const size_t m : chunk.members) {
      EXPECT_NE(static_cast<size_t>(hidden[m].photograph), chunk.reference);
      all.push_back(m);
    }
  }
  EXPECT_THAT(all, ElementsAre(0, 1, 2, 3, 4, 5));  // halved, for all six hide all there is
}

TEST(PlanChunks, SourcesAndSizesAreApart) {
  auto photos = Photos(4);
  auto asked = At(photos, {0, 1, 2, 3}, 0);
  asked[1].proposal.source = "splat";
  asked[3].proposal.camera.width = 50;
  photos[0].camera.width = 50;
  const auto chunks = PlanChunks(asked, photos, 8);
  ASSERT_EQ(chunks.size(), 3u);
  size_t members = 0;
  for (const ViewChunk& chunk : chunks) {
    members += chunk.members.size();
    for (const size_t m : chunk.members) EXPECT_EQ(asked[m].proposal.source, asked[chunk.members[0]].proposal.source);
    const bool narrow = asked[chunk.members[0]].proposal.camera.width == 50;
    EXPECT_EQ(narrow, photos[chunk.reference].camera.width == 50);  // of its own size, where there is one
  }
  EXPECT_EQ(members, 4u);
}

TEST(PlanChunks, TheOnlyPhotographCannotBeHidden) {
  const auto photos = Photos(1);
  EXPECT_THAT([&] { PlanChunks(At(photos, {0}, 1), photos, 4); },
              testing::ThrowsMessage<InputError>(
                  testing::AllOf(testing::StartsWith("t0: VGGT has no photograph"), testing::HasSubstr("--oracle"))));
  EXPECT_EQ(PlanChunks(At(photos, {0}, 0), photos, 4).size(), 1u);
}

}  // namespace
}  // namespace oraclegs
