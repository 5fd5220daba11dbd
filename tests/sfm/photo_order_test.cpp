#include "oraclegs/sfm/photo_order.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "support/matched_ring.h"

namespace oraclegs {
namespace {

constexpr int kPhotos = 12;

/// Every second photo is checked; `belongs[i]` says which photo's pose is listed for photo i.
OrderSearch SearchOf(const std::vector<int>& belongs) {
  const MatchedRing ring = MakeMatchedRing(kPhotos, 30);
  OrderSearch search;
  search.limit = 2;
  std::vector<ViewPair> pairs;
  std::vector<Intrinsics> intrinsics(ring.intrinsics.begin(), ring.intrinsics.begin() + kPhotos / 2);
  for (const ViewPair& pair : ring.pairs) {
    if (pair.a % 2 == 0 && pair.b % 2 == 0) pairs.push_back({pair.a / 2, pair.b / 2, pair.matches});
  }
  search.pairs = RaysOf(pairs, intrinsics);
  for (int i = 0; i < kPhotos; ++i) {
    search.names.push_back(std::to_string(i) + ".jpg");
    search.poses.push_back(ring.cams_from_world[static_cast<size_t>(belongs[static_cast<size_t>(i)])]);
    if (i % 2 == 0) search.views.push_back(i);
  }
  return search;
}

std::vector<int> InOrder() {
  std::vector<int> order(kPhotos);
  std::iota(order.begin(), order.end(), 0);
  return order;
}

void ExpectFound(const std::vector<int>& belongs, const std::string& words) {
  const auto found = FindPhotoOrder(SearchOf(belongs));
  ASSERT_TRUE(found.has_value()) << words;
  EXPECT_EQ(found->words, words);
  EXPECT_GT(found->share, .95) << words;
  for (size_t i = 0; i < found->pose_of_view.size(); ++i)
    EXPECT_EQ(belongs[static_cast<size_t>(found->pose_of_view[i])], 2 * static_cast<int>(i)) << words;
}

TEST(FindPhotoOrder, KeepsTheRightOne) { EXPECT_FALSE(FindPhotoOrder(SearchOf(InOrder())).has_value()); }

TEST(FindPhotoOrder, FindsUsualOrders) {
  std::vector<int> order = InOrder();
  std::reverse(order.begin(), order.end());
  ExpectFound(order, "reversed");
  order = InOrder();
  std::rotate(order.begin(), order.begin() + 1, order.end());
  ExpectFound(order, "each pose stands 1 too early");
  std::rotate(order.begin(), order.end() - 3, order.end());
  ExpectFound(order, "each pose stands 2 too late");
  // Photos are counted 0, 1, 2, ..., but the poses were listed as text sorts: 0, 1, 10, 11, 2, ...
  ExpectFound({0, 1, 10, 11, 2, 3, 4, 5, 6, 7, 8, 9}, "sorted as text (10 before 2) and not as numbers");
}

TEST(FindPhotoOrder, FindsAnyOrder) {
  ExpectFound({7, 2, 5, 11, 0, 9, 4, 1, 10, 3, 8, 6}, "");
  std::vector<int> order = InOrder();
  std::swap(order[2], order[8]);
  ExpectFound(order, "");
}

TEST(FindPhotoOrder, NeedsMatches) {
  OrderSearch search = SearchOf(InOrder());
  search.pairs.clear();
  EXPECT_FALSE(FindPhotoOrder(search).has_value());
}

}  // namespace
}  // namespace oraclegs
