#include "oraclegs/output/view/splat_site.h"

#include <sys/stat.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "oraclegs/formats/codecs.h"
#include "oraclegs/web/site.h"
#include "run/fixtures.h"
#include "support/buffers.h"

namespace oraclegs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
namespace fs = std::filesystem;

/// n Gaussians of one size at x = 0, 1, 2, ...
Gaussians Row(int64_t n) {
  Gaussians g = Gaussians::Zeros(n);
  for (int64_t i = 0; i < n; ++i) {
    g.means[3 * i] = static_cast<float>(i);
    g.quats[4 * i] = 1;
  }
  Flat(g.log_scales).setConstant(-2);
  return g;
}

std::vector<float> Xs(const Gaussians& g) {
  std::vector<float> xs;
  for (int64_t i = 0; i < g.size(); ++i) xs.push_back(g.means[3 * i]);
  return xs;
}

TEST(ShownPart, KeepsTheMostPresentInTheirOrder) {
  EventRecorder recorder;
  GaussianPly splat{Row(5), 0};
  splat.gaussians.log_scales[3 * 3] = splat.gaussians.log_scales[3 * 3 + 1] = 0;  // broad
  splat.gaussians.opacity_logits[1] = 5;                                          // opaque
  splat.gaussians.log_scales[3 * 4] = 0;                                          // long
  const GaussianPly shown = ShownPart(splat, "a.ply", 3, recorder.AsListener());
  EXPECT_THAT(Xs(shown.gaussians), ElementsAre(1, 3, 4));
  EXPECT_THAT(recorder.warnings, ElementsAre(HasSubstr("holds 5 Gaussians; the 3")));
}

TEST(ShownPart, RefusesNothing) {
  EXPECT_THAT(MessageOf<InputError>([] {
                ShownPart({Gaussians::Zeros(0), 0}, "a.ply", 10, Silent());
              }),
              HasSubstr("a.ply: holds no Gaussian"));
}

TEST(WriteSplatSite, MakesADocumentOfAFile) {
  TempDir temp;
  WriteGaussianPly(temp / "a.ply", Row(5), 1, {}, {{0, 0.25, 0.5, 0.75, 1}, {0, 0.1f, 0.2f, 0.3f, 1}});
  fs::create_directory(temp / "site");
  WriteSplatSite(temp / "a.ply", temp / "site", Silent());
  Site site(temp / "site");
  const auto document = nlohmann::json::parse(site.Document().value().json);
  EXPECT_EQ(document.at("kind"), "file");
  EXPECT_EQ(document.at("title"), "a.ply");
  EXPECT_EQ(document.at("splat").at("gaussians"), 5);
  EXPECT_EQ(document.at("splat").at("center"), nlohmann::json({2., 0., 0.}));
  EXPECT_GT(document.at("splat").at("radius"), 0.5);
  const std::string spz = site.File("splat.spz").value().ReadAll(1 << 20).value();
  EXPECT_EQ(document.at("splat").at("bytes"), spz.size());
  EXPECT_EQ(DecodeSpz(spz, "spz").gaussians.size(), 5);
  EXPECT_EQ(site.File("support.bin").value().ReadAll(10), std::string("\x00\x40\x80\xbf\xff", 5));
  EXPECT_EQ(site.File("uncertainty.bin").value().ReadAll(10), std::string("\x00\x55\xaa\xff\xff", 5))
      << "1 is off by 0.3";
}

TEST(WriteSplatSite, WithoutMarksThereAreNone) {
  TempDir temp;
  WriteGaussianPly(temp / "a.ply", Row(2), 0);
  WriteSplatSite(temp / "a.ply", temp.path(), Silent());
  EXPECT_FALSE(fs::exists(temp / "support.bin"));
  EXPECT_FALSE(fs::exists(temp / "uncertainty.bin"));
  EXPECT_TRUE(nlohmann::json::parse(ReadFile(temp / "report" / "run.json")).at("splat").at("support").is_null());
}

TEST(TemporaryFolder, IsPrivateAndGoes) {
  fs::path path;
  {
    const TemporaryFolder folder;
    path = folder.path();
    struct stat info {};
    ASSERT_EQ(stat(path.c_str(), &info), 0);
    EXPECT_EQ(info.st_mode & 0777, 0700u);
    WriteText(path / "a" / "b", "c");
  }
  EXPECT_FALSE(fs::exists(path));
}

}  // namespace
}  // namespace oraclegs
