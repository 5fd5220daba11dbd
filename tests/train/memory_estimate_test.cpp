#include "oraclegs/train/memory_estimate.h"

#include <gmock/gmock.h>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr TrainingSize kMillion{1000000, 1237 * 822, 100 * 1237 * 822 * 3, 160000000};

TEST(MemoryEstimateTest, NamesTheLargestFirst) {
  const std::vector<MemoryItem> items = EstimateMemory(kMillion);
  ASSERT_EQ(items.size(), 4u);
  EXPECT_EQ(items[0].what, "Gaussians and their moments");
  EXPECT_GE(items[0].bytes, 708000000);
  EXPECT_LE(items[0].bytes, 800000000);
  for (size_t i = 1; i < items.size(); ++i) EXPECT_LE(items[i].bytes, items[i - 1].bytes);
  int64_t sum = 0;
  for (const MemoryItem& item : items) sum += item.bytes;
  EXPECT_EQ(TotalBytes(items), sum);
}

TEST(MemoryEstimateTest, SmallMomentsSaveAQuarterAndTwoFifthsOfAGaussian) {
  EXPECT_EQ(ModelBytes(ShMoments::kFull), 708);
  EXPECT_EQ(ModelBytes(ShMoments::kHalf), 516);
  EXPECT_EQ(ModelBytes(ShMoments::kCompact), 424);
  TrainingSize compact = kMillion;
  compact.sh_moments = ShMoments::kCompact;
  EXPECT_EQ(TotalBytes(EstimateMemory(kMillion)) - TotalBytes(EstimateMemory(compact)), 284000000);
}

TEST(MemoryEstimateTest, SaysWhatIsNeededForWhatAndWhatLowersIt) {
  const std::vector<MemoryItem> items = EstimateMemory(kMillion);
  EXPECT_NO_THROW(RequireMemory(items, TotalBytes(items)));
  try {
    RequireMemory(items, 500000000);
    FAIL() << "0.5 GB must not suffice";
  } catch (const RunError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("needs about 1."), HasSubstr("0.74 for Gaussians and their moments"),
                                    HasSubstr("0.50 GB are free"), HasSubstr("--max-gaussians"),
                                    HasSubstr("--downscale"), testing::Not(HasSubstr("\n"))));
  }
}

}  // namespace
}  // namespace oraclegs
