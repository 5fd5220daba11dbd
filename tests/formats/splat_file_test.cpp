#include "oraclegs/formats/splat_file.h"

#include "formats/splats.h"
#include "oraclegs/core/files.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

TEST(SplatFormatOf, GoesByTheEndOfTheName) {
  EXPECT_EQ(SplatFormatOf("a/b.ply"), SplatFormat::kPly);
  EXPECT_EQ(SplatFormatOf("a/b.compressed.ply"), SplatFormat::kCompressedPly);
  EXPECT_EQ(SplatFormatOf("b.SPZ"), SplatFormat::kSpz);
  EXPECT_EQ(SplatFormatOf("b.c.sog"), SplatFormat::kSog);
  EXPECT_EQ(SplatFormatOf("b.splat"), SplatFormat::kSplat);
  EXPECT_EQ(SplatFormatOf("b.glb"), SplatFormat::kGltf);
  EXPECT_EQ(SplatFormatOf("b.spz.glb"), SplatFormat::kGltfSpz);
}

TEST(SplatFormatOf, RefusesAnUnknownEnd) {
  for (const char* name : {"scene.xyz", "scene", ".ply", "dir.ply/", "scene.gltf"}) {
    const std::string message = MessageOf<UsageError>([&] { SplatFormatOf(name); });
    EXPECT_THAT(message, HasSubstr(name));
    EXPECT_THAT(message, HasSubstr(".compressed.ply, .ply, .spz, .sog, .splat, .spz.glb, .glb"));
    EXPECT_FALSE(HasSplatFormat(name));
  }
}

TEST(SplatFile, IsReadAsItWasWritten) {
  const TempDir dir;
  const Gaussians g = PlausibleGaussians(300);
  for (const char* name : {"a.ply", "a.compressed.ply", "a.spz", "a.sog", "a.splat", "a.glb", "a.spz.glb"}) {
    const std::filesystem::path path = dir / name;
    WriteSplat(path, g, 2);
    const GaussianPly read = ReadSplat(path);
    EXPECT_EQ(read.gaussians.size(), 300) << name;
    EXPECT_EQ(read.sh_degree, SplatFormatOf(path) == SplatFormat::kSplat ? 0 : 2) << name;
    EXPECT_EQ(std::string("a") + ExtensionOf(SplatFormatOf(path)), name);
  }
}

TEST(SplatFile, APlyMayBeCompressedUnderEitherName) {
  const TempDir dir;
  WriteSplat(dir / "a.compressed.ply", PlausibleGaussians(30), 1);
  WriteSplat(dir / "b.ply", PlausibleGaussians(30), 1);
  std::filesystem::rename(dir / "a.compressed.ply", dir / "a.ply");
  std::filesystem::rename(dir / "b.ply", dir / "b.compressed.ply");
  EXPECT_EQ(ReadSplat(dir / "a.ply").sh_degree, 1);
  EXPECT_EQ(ReadSplat(dir / "b.compressed.ply").sh_degree, 1);
}

TEST(SplatFile, KeepsSupportWhereTheFormatCan) {
  const TempDir dir;
  const Gaussians g = PlausibleGaussians(4);
  for (const char* name : {"a.ply", "a.sog", "a.glb"}) {
    WriteSplat(dir / name, g, 0, {}, {0.1f, 0.3f, 0.75f, 1.f});
    const GaussianPly read = ReadSplat(dir / name);
    ASSERT_EQ(read.support.size(), 4u) << name;
    for (int64_t i = 0; i < 4; ++i) {
      // The order may have changed: the support stays with its Gaussian.
      int64_t nearest = 0;
      for (int64_t k = 0; k < 4; ++k) {
        const auto distance = [&](int64_t j) {
          return (Table(g.means).row(j) - Table(read.gaussians.means).row(i)).abs().sum();
        };
        if (distance(k) < distance(nearest)) nearest = k;
      }
      EXPECT_EQ(read.support[i] >= 0.75f, nearest >= 2) << name;
      EXPECT_NEAR(read.support[i], (std::vector<float>{0.1f, 0.3f, 0.75f, 1.f})[nearest], 1.f / 256) << name;
    }
  }
  WriteSplat(dir / "a.spz", g, 0, {}, {0.1f, 0.3f, 0.75f, 1.f});
  EXPECT_TRUE(ReadSplat(dir / "a.spz").support.empty());
}

TEST(SplatFile, NamesAMissingOne) {
  EXPECT_THAT(MessageOf<InputError>([] { ReadSplat("/nowhere/a.spz"); }), HasSubstr("/nowhere/a.spz"));
}

TEST(SplatFile, NamesAPlyThatIsNone) {
  const TempDir dir;
  const auto error = [&](const char* name) { return MessageOf<InputError>([&] { ReadSplat(dir / name); }); };
  WriteFileAtomically(dir / "empty.ply", "");
  WriteFileAtomically(dir / "text.ply", "solid\n");
  WriteFileAtomically(dir / "cut.ply", "ply\nformat binary_little_endian 1.0\n");
  std::filesystem::create_directory(dir / "folder.ply");
  for (const char* name : {"empty.ply", "text.ply", "cut.ply", "folder.ply", "missing.ply"}) {
    EXPECT_THAT(error(name), HasSubstr(name));
  }
}

}  // namespace
}  // namespace oraclegs
