#include "oraclegs/formats/spatial_order.h"

#include <algorithm>

#include "formats/splats.h"
#include "oraclegs/gaussians/selection.h"

namespace oraclegs {
namespace {

TEST(SpatialOrder, HoldsEachGaussianOnce) {
  std::vector<int64_t> order = SpatialOrder(PlausibleGaussians(1000));
  std::sort(order.begin(), order.end());
  for (int64_t i = 0; i < 1000; ++i) EXPECT_EQ(order[i], i);
}

TEST(SpatialOrder, PutsNeighborsSideBySide) {
  const Gaussians g = PlausibleGaussians(4000);
  const auto length = [](const Gaussians& path) {
    double sum = 0;
    for (int64_t i = 1; i < path.size(); ++i) {
      sum += (Table(path.means).row(i) - Table(path.means).row(i - 1)).matrix().norm();
    }
    return sum;
  };
  EXPECT_LT(length(Picked(g, SpatialOrder(g))), length(g) / 5);
}

TEST(SpatialOrder, GivesGroupsSmallBoxes) {
  Gaussians g = PlausibleGaussians(4000);
  for (int c = 0; c < 3; ++c) g.means[c] = 1e6f;  // one far away spoils its own group alone
  const Gaussians sorted = Picked(g, SpatialOrder(g));
  int large = 0;
  for (int64_t begin = 0; begin < 4000; begin += kSpatialGroup) {
    const auto group = Table(sorted.means).middleRows(begin, std::min(kSpatialGroup, 4000 - begin));
    large += (group.colwise().maxCoeff() - group.colwise().minCoeff()).prod() > 30 ? 1 : 0;  // of 400 in all
  }
  EXPECT_LE(large, 3);
}

TEST(SpatialOrder, OfOneAndOfEqualPlaces) {
  EXPECT_EQ(SpatialOrder(PlausibleGaussians(1)), std::vector<int64_t>{0});
  EXPECT_EQ(SpatialOrder(Gaussians::Zeros(1000)).size(), 1000u);
}

}  // namespace
}  // namespace oraclegs
