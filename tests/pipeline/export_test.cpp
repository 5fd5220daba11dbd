#include "oraclegs/pipeline/export.h"

#include <cmath>

#include "oraclegs/gaussians/ply.h"
#include "pipeline/fixtures.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

/// Gaussian i stands at x = i, with opacity (i + 1) / (n + 1) and scale exp(-i).
Gaussians Row(int n) {
  Gaussians g = Gaussians::Zeros(n);
  for (int i = 0; i < n; ++i) {
    const double o = (i + 1.0) / (n + 1);
    g.means[3 * i] = static_cast<float>(i);
    g.opacity_logits[i] = static_cast<float>(std::log(o / (1 - o)));
    std::fill_n(g.log_scales.data() + 3 * i, 3, static_cast<float>(-i));
    g.quats[4 * i] = 1;
    std::fill_n(g.sh.data() + 48 * i, 48, 0.1f * static_cast<float>(i));
  }
  return g;
}

std::vector<float> Places(const Gaussians& g) {
  std::vector<float> x;
  for (int64_t i = 0; i < g.size(); ++i) x.push_back(g.means[3 * i]);
  return x;
}

TEST(Pruned, KeepsAllByDefault) { EXPECT_EQ(Pruned(Row(4), {}).size(), 4); }

TEST(Pruned, DropsFaintGaussians) {
  EXPECT_THAT(Places(Pruned(Row(4), {.min_opacity = 0.5})), testing::ElementsAre(2, 3));  // opacities 0.6 and 0.8
}

TEST(Pruned, KeepsTheLargestInTheirOrder) {
  // Weight (i + 1) exp(-2 i): the first ones cover most, although they are faintest.
  EXPECT_THAT(Places(Pruned(Row(5), {.max_gaussians = 2})), testing::ElementsAre(0, 1));
}

TEST(ExportPly, WritesThePrunedModel) {
  const TempDir temp;
  WriteGaussianPly(temp / "in.ply", Row(4));
  const ExportResult result = ExportPly(temp / "in.ply", temp / "out.ply", {.sh_degree = 1, .min_opacity = 0.5});
  EXPECT_EQ(result.before, 4);
  EXPECT_EQ(result.after, 2);
  const GaussianPly back = ReadGaussianPly(temp / "out.ply");
  EXPECT_EQ(back.sh_degree, 1);
  EXPECT_THAT(Places(back.gaussians), testing::ElementsAre(2, 3));
  EXPECT_EQ(ExportPly(temp / "out.ply", temp / "again.ply", {}).sh_degree, 1);  // no higher than the file's own
}

TEST(ExportPly, WritesNothingWhenNothingIsLeft) {
  const TempDir temp;
  WriteGaussianPly(temp / "in.ply", Row(4));
  EXPECT_THROW(ExportPly(temp / "in.ply", temp / "out.ply", {.min_opacity = 0.99}), UsageError);
  EXPECT_THROW(ExportPly(temp / "none.ply", temp / "out.ply", {}), InputError);
  EXPECT_FALSE(std::filesystem::exists(temp / "out.ply"));
}

TEST(ExportPly, KeepsComments) {
  const TempDir temp;
  WriteGaussianPly(temp / "in.ply", Row(4), 3, {"not for commercial use: made with X"});
  ExportPly(temp / "in.ply", temp / "out.ply", {});
  EXPECT_THAT(ReadGaussianPly(temp / "out.ply").comments, testing::ElementsAre("not for commercial use: made with X"));
}

}  // namespace
}  // namespace oraclegs
