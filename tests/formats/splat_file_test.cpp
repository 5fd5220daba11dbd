#include "oraclegs/formats/splat_file.h"

#include <array>
#include <limits>
#include <random>

#include "formats/splats.h"
#include "oraclegs/core/files.h"
#include "oraclegs/formats/codecs.h"
#include "oraclegs/formats/zip_archive.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

constexpr const char* kEveryFormat[] = {"a.ply", "a.compressed.ply", "a.spz",  "a.sog", "a.splat",
                                        "a.glb", "a.spz.glb",        "a.usda", "a.usdz"};

TEST(SplatFormatOf, GoesByTheEndOfTheName) {
  EXPECT_EQ(SplatFormatOf("a/b.ply").extension, ".ply");
  EXPECT_EQ(SplatFormatOf("a/b.compressed.ply").extension, ".compressed.ply");
  EXPECT_EQ(SplatFormatOf("b.SPZ").extension, ".spz");
  EXPECT_EQ(SplatFormatOf("b.c.sog").extension, ".sog");
  EXPECT_EQ(SplatFormatOf("b.splat").extension, ".splat");
  EXPECT_EQ(SplatFormatOf("b.glb").extension, ".glb");
  EXPECT_EQ(SplatFormatOf("b.spz.glb").extension, ".spz.glb");
}

TEST(SplatFormatOf, RefusesAnUnknownEnd) {
  for (const char* name : {"scene.xyz", "scene", ".ply", "dir.ply/"}) {
    const std::string message = MessageOf<UsageError>([&] { SplatFormatOf(name); });
    EXPECT_THAT(message, HasSubstr(name));
    EXPECT_THAT(message,
                HasSubstr("ends in .ply, .compressed.ply, .spz, .sog, .splat, .glb, .spz.glb, .usda or .usdz"));
  }
}

TEST(SplatFile, IsReadAsItWasWritten) {
  const TempDir dir;
  const Gaussians g = PlausibleGaussians(300);
  for (const char* name : kEveryFormat) {
    const std::filesystem::path path = dir / name;
    WriteSplat(path, {g, 2});
    const GaussianPly read = ReadSplat(path);
    EXPECT_EQ(read.gaussians.size(), 300) << name;
    EXPECT_EQ(read.sh_degree, std::min(2, SplatFormatOf(path).max_sh_degree)) << name;
    EXPECT_EQ("a" + SplatFormatOf(path).extension, name);
  }
}

TEST(SplatFile, APlyMayBeCompressedUnderEitherName) {
  const TempDir dir;
  WriteSplat(dir / "a.compressed.ply", {PlausibleGaussians(30), 1});
  WriteSplat(dir / "b.ply", {PlausibleGaussians(30), 1});
  std::filesystem::rename(dir / "a.compressed.ply", dir / "a.ply");
  std::filesystem::rename(dir / "b.ply", dir / "b.compressed.ply");
  EXPECT_EQ(ReadSplat(dir / "a.ply").sh_degree, 1);
  EXPECT_EQ(ReadSplat(dir / "b.compressed.ply").sh_degree, 1);
}

TEST(SplatFile, KeepsSupportWhereTheFormatCan) {
  const TempDir dir;
  const Gaussians g = PlausibleGaussians(4);
  for (const char* name : {"a.ply", "a.sog", "a.glb"}) {
    WriteSplat(dir / name, {g, 0, {}, {{0.1f, 0.3f, 0.75f, 1.f}}});
    const GaussianPly read = ReadSplat(dir / name);
    ASSERT_EQ(read.marks.support.size(), 4u) << name;
    for (int64_t i = 0; i < 4; ++i) {
      // The order may have changed: the support stays with its Gaussian.
      int64_t nearest = 0;
      for (int64_t k = 0; k < 4; ++k) {
        const auto distance = [&](int64_t j) {
          return (Table(g.means).row(j) - Table(read.gaussians.means).row(i)).abs().sum();
        };
        if (distance(k) < distance(nearest)) nearest = k;
      }
      EXPECT_EQ(read.marks.support[i] >= 0.75f, nearest >= 2) << name;
      EXPECT_NEAR(read.marks.support[i], (std::vector<float>{0.1f, 0.3f, 0.75f, 1.f})[nearest], 1.f / 256) << name;
    }
  }
  WriteSplat(dir / "a.spz", {g, 0, {}, {{0.1f, 0.3f, 0.75f, 1.f}}});
  EXPECT_TRUE(ReadSplat(dir / "a.spz").marks.support.empty());
}

TEST(SplatFormatOf, SaysHowToConvertWhatIsNotRead) {
  const auto error = [](const char* name) { return MessageOf<UsageError>([&] { SplatFormatOf(name); }); };
  EXPECT_THAT(error("a/Scene.KSPLAT"), HasSubstr("Scene.KSPLAT: .ksplat is the private format of one viewer, which is "
                                                 "neither read nor written; convert it to .ply"));
  EXPECT_THAT(error("a.lcc"), HasSubstr("splat-transform scene.lcc scene.ply"));
  EXPECT_THAT(error("a.rad"), HasSubstr("take the file that it was made of"));
  EXPECT_THAT(error("a.usdc"), HasSubstr("usdcat --flatten scene.usdc -o scene.usda"));
  EXPECT_THAT(error("a.usd"), HasSubstr("usdcat --flatten scene.usd -o scene.usda"));
  EXPECT_THAT(error("a.gltf"), HasSubstr("write one .glb"));
}

TEST(SplatNameOf, IsTheNameWithoutTheLongestEnd) {
  EXPECT_EQ(SplatNameOf("a/b.c.compressed.ply"), "b.c");
  EXPECT_EQ(SplatNameOf("b.SPZ"), "b");
  EXPECT_EQ(SplatNameOf("b.ksplat"), "b");
  for (const char* name : {"b.jpg", ".ply", "ply", "b.ply.txt"}) EXPECT_EQ(SplatNameOf(name), std::nullopt) << name;
}

TEST(SplatFile, ReadsAFolderOfSogAndItsDescription) {
  const TempDir dir;
  for (const auto& [name, bytes] : ReadZip(EncodeSog(PlausibleGaussians(30), 1), 20, "x.sog")) {
    WriteFileAtomically(dir / name, bytes);
  }
  EXPECT_TRUE(IsSplatFolder(dir.path()));
  EXPECT_EQ(ReadSplat(dir.path()).gaussians.size(), 30);
  EXPECT_EQ(ReadSplat(dir / "meta.json").gaussians.size(), 30);
}

TEST(SplatFile, SaysWhatAReaderLeftOut) {
  const TempDir dir;
  const Gaussians g = PlausibleGaussians(20);
  g.means[4] = NAN;
  EventRecorder recorder;
  WriteGaussianPly(dir / "a.ply", g, 0);
  EXPECT_EQ(ReadSplat(dir / "a.ply", recorder.AsListener()).gaussians.size(), 19);
  EXPECT_THAT(recorder.warnings, testing::ElementsAre(HasSubstr("1 of 20 Gaussians")));
}

TEST(SplatFile, KeepsTheMarkOfAntialiasedTrainingOrSaysThatItCannot) {
  const TempDir dir;
  GaussianPly splat{PlausibleGaussians(20), 0};
  splat.antialiased = true;
  for (const char* name : kEveryFormat) {
    EventRecorder recorder;
    WriteSplat(dir / name, splat, recorder.AsListener());
    EXPECT_EQ(ReadSplat(dir / name).antialiased, SplatFormatOf(name).keeps_antialiased) << name;
    EXPECT_NE(ReadSplat(dir / name).antialiased, !recorder.warnings.empty()) << name;
    WriteSplat(dir / name, {splat.gaussians, 0});
    EXPECT_FALSE(ReadSplat(dir / name).antialiased) << name;
  }
}

TEST(SplatFile, OneGaussianThatAFormatCannotHoldIsLeftOut) {
  const TempDir dir;
  const Gaussians g = PlausibleGaussians(2000);
  g.means[3 * 7] = 1e9f;
  EventRecorder recorder;
  EXPECT_EQ(WriteSplat(dir / "a.spz", {g, 0, {}, {}}, recorder.AsListener()), 1999);
  EXPECT_THAT(recorder.warnings, testing::ElementsAre(testing::AllOf(HasSubstr("1 of 2000 Gaussians are left out"),
                                                                     HasSubstr("at (1e+09, "))));
  EXPECT_EQ(ReadSplat(dir / "a.spz").gaussians.size(), 1999);
}

TEST(SplatFile, RefusesWhatAFormatCannotHold) {
  const TempDir dir;
  const Gaussians far = PlausibleGaussians(200), huge = PlausibleGaussians(200);
  Flat(far.means) += 5e6f;
  Flat(huge.log_scales) += 30;
  const auto error = [&](const char* name, const Gaussians& g) {
    return MessageOf<InputError>([&] { WriteSplat(dir / name, {g, 0}); });
  };
  EXPECT_THAT(error("a.spz", far), HasSubstr("of 200 Gaussians are not kept by .spz"));
  EXPECT_THAT(error("a.spz.glb", far), HasSubstr("it is moved by"));
  EXPECT_THAT(error("a.sog", huge), HasSubstr("its standard deviation"));
  EXPECT_EQ(error("a.ply", huge) + error("a.glb", huge) + error("a.ply", far), "");
  EXPECT_FALSE(std::filesystem::exists(dir / "a.spz"));
}

TEST(SplatFile, SaysThatColorsAreCut) {
  const TempDir dir;
  const Gaussians g = PlausibleGaussians(100);
  g.sh[0] = 20;
  EventRecorder recorder;
  WriteSplat(dir / "a.spz", {g, 3}, recorder.AsListener());
  EXPECT_THAT(recorder.notes, testing::ElementsAre(HasSubstr("colors of 1 of 100 Gaussians")));
  Table(g.sh).leftCols(3) = 20.f;
  WriteSplat(dir / "a.spz", {g, 3}, recorder.AsListener());
  EXPECT_THAT(recorder.warnings, testing::ElementsAre(HasSubstr("colors of 100 of 100 Gaussians")));
}

/// A number as in files of diverged trainings, or an extreme float.
float ExtremeFloat(std::mt19937_64* random) {
  constexpr float kMost = std::numeric_limits<float>::max(), kLeast = std::numeric_limits<float>::denorm_min();
  constexpr float kExtremes[] = {kMost, 1e30f,  1e10f,  1e5f,   300,   30,   9,        1,
                                 0,     kLeast, 1e-38f, 1e-20f, 1e-6f, 0.5f, INFINITY, NAN};
  const float value = kExtremes[(*random)() % std::size(kExtremes)];
  return (*random)() % 2 == 0 ? value : -value;
}

/// Plausible Gaussians with one extreme number in `rarity`.
Gaussians ExtremeGaussians(int64_t n, uint32_t rarity, uint64_t seed) {
  Gaussians g = PlausibleGaussians(n, seed);
  std::mt19937_64 random(seed);
  g.ForEach([&](const char*, Buffer<float>& part) {
    for (float& x : part.span()) {
      if (random() % rarity == 0) x = ExtremeFloat(&random);
    }
  });
  return g;
}

/// The Gaussian of `all` that is nearest to a position, by its largest difference along an axis.
double DistanceToNearest(const Gaussians& all, const float* to) {
  double nearest = INFINITY;
  for (int64_t i = 0; i < all.size(); ++i) {
    double distance = 0;
    for (int c = 0; c < 3; ++c) distance = std::max(distance, std::abs(double{all.means[3 * i + c]} - double{to[c]}));
    if (distance < nearest) nearest = distance;
  }
  return nearest;
}

TEST(SplatFile, ExtremeNumbersAreWrittenAsPromisedOrRefused) {
  const TempDir dir;
  int written = 0, refused = 0;
  for (uint64_t seed = 1; seed <= 60; ++seed) {
    const uint32_t rarity = std::array{1u, 3u, 60u, 3000u, 100000u}[seed % 5];
    const int64_t n = seed % 3 == 0 ? 1 : static_cast<int64_t>(20 + 10 * seed);
    const GaussianPly given{ExtremeGaussians(n, rarity, seed), static_cast<int>(seed % 4)};
    for (const char* name : kEveryFormat) {
      EventRecorder recorder;
      std::filesystem::remove(dir / name);
      const std::string error = MessageOf<InputError>([&] { WriteSplat(dir / name, given, recorder.AsListener()); });
      refused += error.empty() ? 0 : 1;
      EXPECT_EQ(std::filesystem::exists(dir / name), error.empty());
      if (!error.empty()) continue;
      ++written;
      const GaussianPly read = ReadSplat(dir / name);
      EXPECT_TRUE(read.warnings.empty()) << name << " " << seed << ": " << read.warnings[0];
      EXPECT_EQ(read.gaussians.size() < n,
                !recorder.warnings.empty() && recorder.warnings[0].find("are left out") != std::string::npos);
      for (int64_t i = 0; i < read.gaussians.size(); ++i) {
        const GaussianRows g = read.gaussians.Rows().From(i);
        const double size = std::exp(double{std::max({g.log_scales[0], g.log_scales[1], g.log_scales[2], -4.f})});
        const double distance = std::max({std::abs(g.means[0]), std::abs(g.means[1]), std::abs(g.means[2])});
        EXPECT_LE(DistanceToNearest(given.gaussians, g.means), 1.1 * size + 0.002 * distance) << name << " " << seed;
      }
    }
  }
  EXPECT_GT(written, 60);
  EXPECT_GT(refused, 60);
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
