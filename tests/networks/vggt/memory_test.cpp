#include "oraclegs/networks/vggt/memory.h"

#include <gtest/gtest.h>

namespace oraclegs::vggt {
namespace {

TEST(VggtMemory, WeightsAreThoseOfTheSpecification) {
  EXPECT_EQ(WeightBytes({}, {}), 909112320 * int64_t{4});
  EXPECT_EQ(WeightBytes({}, {true, true}), (909112320 + 216174610 + 32654562) * int64_t{4});
}

TEST(VggtMemory, APassGrowsWithWhatIsAsked) {
  const Pass few{2, 350, 518, {}}, many{9, 350, 518, {}}, large{2, 518, 518, {}};
  const Pass heads{2, 350, 518, {true, true}};
  const int64_t bytes = PassBytes({}, few);
  EXPECT_GT(bytes, int64_t{128} << 20);
  EXPECT_LT(bytes, int64_t{1} << 30);
  EXPECT_GT(PassBytes({}, many), bytes);
  EXPECT_GT(PassBytes({}, large), bytes);
  EXPECT_GT(PassBytes({}, heads), bytes);
  // Four views of 518 x 350 fit into 3 GiB beside the weights.
  EXPECT_LT(PassBytes({}, {4, 350, 518, {true, true}}), int64_t{3} << 30);
}

}  // namespace
}  // namespace oraclegs::vggt
