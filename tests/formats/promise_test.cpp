#include "oraclegs/formats/promise.h"

#include "formats/splats.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

constexpr SplatPromise kPromise{0.25f, 0.1f, 0.01f, 0, 1, 0.1f, 1};

/// Small gray Gaussians on a line, a unit apart.
Gaussians Row(int64_t n) {
  Gaussians g = Gaussians::Zeros(n);
  Flat(g.log_scales) = -2.3026f;  // 0.1
  for (int64_t i = 0; i < n; ++i) {
    g.means[3 * i] = static_cast<float>(i);
    g.quats[4 * i] = 1;
  }
  return g;
}

/// Result of the check when `change` alters a number of the third of five Gaussians.
template <class Change>
PromiseCheck AfterReading(Change&& change) {
  const Gaussians given = Row(5), read = Row(5);
  change(read.Rows().From(2));
  return CheckPromise(given, read, kPromise);
}

TEST(CheckPromise, IsKeptByTheSameNumbers) {
  const PromiseCheck check = CheckPromise(Row(5), Row(5), kPromise);
  EXPECT_TRUE(check.lost.empty());
  EXPECT_EQ(check.cut, 0);
}

TEST(CheckPromise, MeasuresPlacesByTheSizeOfGaussians) {
  EXPECT_TRUE(AfterReading([](const GaussianRows& g) { g.means[1] += 0.024f; }).lost.empty());
  const PromiseCheck check = AfterReading([](const GaussianRows& g) { g.means[1] += 0.03f; });
  EXPECT_THAT(check.lost, testing::ElementsAre(2));
  EXPECT_THAT(check.first, HasSubstr("(2, 0, 0), it is moved by 0.03"));
  EXPECT_EQ(AfterReading([](const GaussianRows& g) { g.means[1] = INFINITY; }).lost.size(), 1u);
}

TEST(CheckPromise, FarPlacesMayBeOffByAThousandth) {
  const Gaussians given = Row(5), read = Row(5);
  given.means[12] = 10000, read.means[12] = 10009;
  EXPECT_TRUE(CheckPromise(given, read, kPromise).lost.empty());
  read.means[12] = 10011;
  EXPECT_EQ(CheckPromise(given, read, kPromise).lost.size(), 1u);
}

TEST(CheckPromise, FlatGaussiansMayBeThickerWhereNobodySeesIt) {
  const Gaussians given = Row(5), read = Row(5);
  given.log_scales[0] = -69;
  read.log_scales[0] = -4;
  EXPECT_TRUE(CheckPromise(given, read, kPromise).lost.empty());
  read.log_scales[0] = -3;
  EXPECT_THAT(CheckPromise(given, read, kPromise).first, HasSubstr("standard deviation 1.08e-30 becomes 0.0498"));
}

TEST(CheckPromise, LooksAtEveryAttribute) {
  EXPECT_THAT(AfterReading([](const GaussianRows& g) { g.log_scales[2] = 5; }).first, HasSubstr("becomes 148"));
  EXPECT_THAT(AfterReading([](const GaussianRows& g) { g.quats[1] = 1; }).first, HasSubstr("rotation"));
  EXPECT_TRUE(AfterReading([](const GaussianRows& g) { g.quats[0] = -2; }).lost.empty());
  EXPECT_THAT(AfterReading([](const GaussianRows& g) { *g.opacity_logits = 1; }).first,
              HasSubstr("opacity 0.5 becomes"));
  EXPECT_THAT(AfterReading([](const GaussianRows& g) { g.sh[1] = 1; }).first, HasSubstr("color 0.5 becomes 0.782"));
  EXPECT_EQ(AfterReading([](const GaussianRows& g) { g.sh[40] = 0.5f; }).lost.size(), 1u);
  EXPECT_EQ(AfterReading([](const GaussianRows& g) { g.sh[40] = NAN; }).lost.size(), 1u);
}

TEST(CheckPromise, CountsWhatIsCut) {
  const Gaussians given = Row(5), read = Row(5);
  given.sh[0] = 30, read.sh[0] = 0.5f / static_cast<float>(kConstantSh);  // to the color 1
  given.sh[kShFloats + 3] = -1e30f, read.sh[kShFloats + 3] = -1;
  const PromiseCheck check = CheckPromise(given, read, kPromise);
  EXPECT_TRUE(check.lost.empty()) << check.first;
  EXPECT_EQ(check.cut, 2);
}

}  // namespace
}  // namespace oraclegs
