#include "oraclegs/output/export.h"

#include <cmath>
#include <iterator>
#include <sstream>

#include "oraclegs/camera/camera_path.h"
#include "oraclegs/core/files.h"
#include "oraclegs/gaussians/ply.h"
#include "oraclegs/render/render.h"
#include "oraclegs/stages/evaluate_stage.h"
#include "run/fixtures.h"
#include "support/buffers.h"
#include "support/event_recorder.h"
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

GaussianPly RowSplat(int n, std::vector<float> support = {}) { return {Row(n), 3, {}, {std::move(support)}}; }

std::vector<float> PlacesLeft(const GaussianPly& splat, const ExportOptions& options, const std::string& crop = "") {
  return Places(Pruned(splat, options, ParseCrop(crop), "in.ply").gaussians);
}

ExportResult Export(const std::filesystem::path& from, const std::filesystem::path& to, const ExportOptions& options) {
  return ExportSplat({from, to}, options, std::nullopt, Silent());
}

TEST(Pruned, KeepsAllByDefault) { EXPECT_EQ(PlacesLeft(RowSplat(4), {}).size(), 4u); }

TEST(Pruned, DropsFaintGaussians) {
  EXPECT_THAT(PlacesLeft(RowSplat(4), {.min_opacity = 0.5}), testing::ElementsAre(2, 3));  // opacities 0.6 and 0.8
}

TEST(Pruned, KeepsTheLargestInTheirOrder) {
  // Weight (i + 1) exp(-2 i): the first ones cover most, although they are faintest.
  EXPECT_THAT(PlacesLeft(RowSplat(5), {.max_gaussians = 2}), testing::ElementsAre(0, 1));
}

TEST(Pruned, DropsWhatLittleSupports) {
  const GaussianPly kept = Pruned(RowSplat(3, {0.2f, 0.5f, 1}), {.min_support = 0.5}, {}, "in.ply");
  EXPECT_THAT(Places(kept.gaussians), testing::ElementsAre(1, 2));
  EXPECT_THAT(kept.marks.support, testing::ElementsAre(0.5f, 1));
  GaussianPly known = RowSplat(3);
  known.marks.uncertainty = {0.3f, 0.01f, 0.05f};
  EXPECT_THAT(Pruned(known, {.max_uncertainty = 0.05}, {}, "in.ply").marks.uncertainty,
              testing::ElementsAre(0.01f, 0.05f));
  EXPECT_THAT(MessageOf<InputError>([] { PlacesLeft(RowSplat(3), {.max_uncertainty = 0.05}); }),
              testing::HasSubstr("in.ply: says nothing of how sure"));
  EXPECT_THAT(MessageOf<InputError>([] { PlacesLeft(RowSplat(3), {.min_support = 0.5}); }),
              testing::HasSubstr("in.ply: says nothing of the support"));
}

TEST(Pruned, Crops) {
  EXPECT_THAT(PlacesLeft(RowSplat(5), {}, "box:0.5,-1,-1,2.5,1,1"), testing::ElementsAre(1, 2));
  EXPECT_THAT(PlacesLeft(RowSplat(5), {}, "sphere:4,0,0,1"), testing::ElementsAre(3, 4));
}

TEST(ExportSplat, WritesThePrunedModel) {
  const TempDir temp;
  WriteGaussianPly(temp / "in.ply", Row(4));
  const ExportResult result = Export(temp / "in.ply", temp / "out.ply", {.sh_degree = 1, .min_opacity = 0.5});
  EXPECT_EQ(result.before, 4);
  EXPECT_EQ(result.after, 2);
  EXPECT_EQ(result.bytes, std::filesystem::file_size(temp / "out.ply"));
  const GaussianPly back = ReadGaussianPly(temp / "out.ply");
  EXPECT_EQ(back.sh_degree, 1);
  EXPECT_THAT(Places(back.gaussians), testing::ElementsAre(2, 3));
  EXPECT_EQ(Export(temp / "out.ply", temp / "again.ply", {}).sh_degree, 1);  // no higher than the file's own
}

TEST(ExportSplat, WritesNothingWhenNothingIsLeft) {
  const TempDir temp;
  WriteGaussianPly(temp / "in.ply", Row(4));
  EXPECT_THROW(Export(temp / "in.ply", temp / "out.ply", {.min_opacity = 0.99}), UsageError);
  EXPECT_THROW(Export(temp / "in.ply", temp / "out.ply", {.crop = "sphere:99,0,0,1"}), UsageError);
  EXPECT_THROW(Export(temp / "none.ply", temp / "out.ply", {}), InputError);
  EXPECT_FALSE(std::filesystem::exists(temp / "out.ply"));
}

TEST(ExportSplat, TellsUsdHowLongAUnitIs) {
  const TempDir temp;
  WriteGaussianPly(temp / "in.ply", Row(3), 0, {"a unit is 0.5 m"});
  Export(temp / "in.ply", temp / "m.usda", {});
  EXPECT_THAT(ReadFile(temp / "m.usda"), testing::HasSubstr("metersPerUnit = 1\n"));
  Export(temp / "in.ply", temp / "same.usda", {.scale = 1});
  EXPECT_THAT(ReadFile(temp / "same.usda"), testing::HasSubstr("metersPerUnit = 0.5\n"));
  Export(temp / "same.usda", temp / "back.ply", {});
  EXPECT_NEAR(ReadGaussianPly(temp / "back.ply").gaussians.means[6], 1, 1e-6);
}

TEST(ExportSplat, WritesSpzOfTheVersionThatIsAskedFor) {
  const TempDir temp;
  Gaussians g = Row(4);
  Flat(g.log_scales) = -2.f;
  WriteGaussianPly(temp / "in.ply", g, 0);
  Export(temp / "in.ply", temp / "3.spz", {});
  Export(temp / "in.ply", temp / "4.spz", {.spz_version = 4});
  EXPECT_EQ(ReadFile(temp / "3.spz").substr(0, 2), "\x1f\x8b");
  EXPECT_EQ(ReadFile(temp / "4.spz").substr(0, 5), "NGSP\4");
  EXPECT_EQ(Places(ReadSplat(temp / "4.spz").gaussians), Places(ReadSplat(temp / "3.spz").gaussians));
  EXPECT_THAT(MessageOf<UsageError>([&] { Export(temp / "in.ply", temp / "a.sog", {.spz_version = 4}); }),
              testing::HasSubstr("a.sog: is no .spz file, which --spz-version is for"));
}

TEST(ExportSplat, KeepsCommentsOrSaysThatItCannot) {
  const TempDir temp;
  WriteGaussianPly(temp / "in.ply", Row(4), 3, {"not for commercial use: made with X"});
  Export(temp / "in.ply", temp / "out.ply", {});
  EXPECT_THAT(ReadGaussianPly(temp / "out.ply").comments, testing::ElementsAre("not for commercial use: made with X"));
  EventRecorder events;
  ExportSplat({temp / "in.ply", temp / "out.spz"}, {}, std::nullopt, events.AsListener());
  EXPECT_THAT(events.notes, testing::Contains(testing::HasSubstr("not for commercial use: made with X")));
}

TEST(ExportSplat, TurnsUpToTheFilesAxisAndScales) {
  const TempDir temp;
  Gaussians g = Row(1);
  g.means[0] = 0, g.means[1] = -2;  // two up
  WriteGaussianPly(temp / "in.ply", g);
  Export(temp / "in.ply", temp / "z.ply", {.up = "z", .scale = 3});
  const Gaussians z = ReadGaussianPly(temp / "z.ply").gaussians;
  EXPECT_NEAR(z.means[2], 6, 1e-5);
  EXPECT_NEAR(z.log_scales[0], std::log(3.), 1e-5);
  // In glTF y is up, as in the program -y is: nothing turns.
  Export(temp / "in.ply", temp / "y.glb", {.up = "y"});
  EXPECT_NEAR(ReadSplat(temp / "y.glb").gaussians.means[1], -2, 1e-5);
  const ExportCameras cameras{{Eigen::Vector3d::Zero(), 1}, Eigen::Vector3d::UnitX()};
  ExportSplat({temp / "in.ply", temp / "x.ply"}, {.up = "auto"}, cameras, Silent());
  EXPECT_NEAR(ReadSplat(temp / "x.ply").gaussians.means[0], -2, 1e-5);  // x has become -y, and -y -x
}

TEST(ExportSplat, IsInMetersWhereTheUnitIsKnown) {
  const TempDir temp;
  WriteGaussianPly(temp / "in.ply", Row(3), 3, {"up is -y, the origin is what the cameras look at", "a unit is 0.5 m"});
  Export(temp / "in.ply", temp / "m.ply", {});
  const GaussianPly meters = ReadGaussianPly(temp / "m.ply");
  EXPECT_NEAR(meters.gaussians.means[6], 1, 1e-6);
  EXPECT_NEAR(meters.gaussians.log_scales[0], std::log(0.5), 1e-6);
  EXPECT_THAT(meters.comments,
              testing::ElementsAre("up is -y, the origin is what the cameras look at", "a unit is 1 m"));
  Export(temp / "m.ply", temp / "again.ply", {});
  EXPECT_EQ(ReadFile(temp / "again.ply"), ReadFile(temp / "m.ply"));
  Export(temp / "in.ply", temp / "same.ply", {.scale = 1});
  EXPECT_EQ(ReadGaussianPly(temp / "same.ply").gaussians.means[6], 2);
  Export(temp / "in.ply", temp / "turned.ply", {.up = "z"});
  EXPECT_THAT(ReadGaussianPly(temp / "turned.ply").comments, testing::ElementsAre("a unit is 1 m"));
}

TEST(LoadModel, BringsAnExportInMetersBackToTheScene) {
  const TempDir temp;
  WriteGaussianPly(temp / "in.ply", Row(3), 3, {"a unit is 0.5 m"});
  Export(temp / "in.ply", temp / "m.ply", {});
  const Model model = LoadModel(temp / "m.ply", {}, kCpu, {.unit_meters = 0.5});
  EXPECT_NEAR(model.gaussians.means[6], 2, 1e-6);
  EXPECT_EQ(model.unit_meters, 0.5);
  EXPECT_NEAR(LoadModel(temp / "m.ply", {}, kCpu).gaussians.means[6], 1, 1e-6);
}

TEST(LoadModel, IsRenderedAsItsFileSaysThatItWasTrained) {
  const TempDir temp;
  WriteGaussianPly(temp / "in.ply", Row(3), 3, {kAntialiasedComment});
  EventRecorder recorder;
  EXPECT_TRUE(LoadModel(temp / "in.ply", {}, kCpu, {}, recorder.AsListener()).render.antialiased);
  EXPECT_THAT(recorder.notes, testing::ElementsAre(testing::HasSubstr("trained antialiased")));
  WriteGaussianPly(temp / "in.ply", Row(3), 3);
  EXPECT_FALSE(LoadModel(temp / "in.ply", {}, kCpu).render.antialiased);
}

TEST(ExportSplat, SaysWhatItReadsAndCannotWrite) {
  const TempDir temp;
  Gaussians g = Row(20);
  Flat(g.log_scales).setConstant(-3);
  g.means[3] = NAN;
  WriteGaussianPly(temp / "in.ply", g, 0, {kAntialiasedComment});
  EventRecorder recorder;
  const ExportResult result = ExportSplat({temp / "in.ply", temp / "out.glb"}, {}, std::nullopt, recorder.AsListener());
  EXPECT_EQ(result.before, 19);
  EXPECT_EQ(result.after, 19);
  EXPECT_THAT(recorder.warnings, testing::ElementsAre(testing::HasSubstr("in.ply: 1 of 20 Gaussians"),
                                                      testing::HasSubstr("out.glb: .glb cannot say")));
}

/// A format of the smallest kind, which is one row: positions as text, z up, nothing else kept.
std::string EncodePlaces(const GaussianPly& splat) {
  std::string text;
  for (const float x : splat.gaussians.means.span()) text += fmt::format("{} ", x);
  return text;
}

GaussianPly DecodePlaces(std::string_view bytes, const std::string&) {
  std::istringstream stream{std::string(bytes)};
  const std::vector<float> places{std::istream_iterator<float>(stream), {}};
  GaussianPly splat{Gaussians::Zeros(static_cast<int64_t>(places.size() / 3)), 0};
  std::copy(places.begin(), places.end(), splat.gaussians.means.data());
  for (int64_t i = 0; i < splat.gaussians.size(); ++i) splat.gaussians.quats[4 * i] = 1;
  return splat;
}

TEST(ExportSplat, TakesAnotherRowLikeItsOwn) {
  const TempDir temp;
  std::vector<SplatFormat> formats = SplatFormats();
  formats.push_back({.extension = ".places.ply",
                     .promise = {0, 1e-4f, 0, 0.4f, 0.6f, 0, 0},
                     .half_turn = 2 | 4,
                     .max_sh_degree = 0,
                     .decode = DecodePlaces,
                     .encode = EncodePlaces});
  Gaussians g = Gaussians::Zeros(2);
  g.means[1] = -2;  // two up
  g.quats[0] = g.quats[4] = 1;
  WriteGaussianPly(temp / "in.ply", g, 2, {"not for commercial use: made with X"});
  EventRecorder events;
  const ExportResult result =
      ExportSplat({temp / "in.ply", temp / "out.places.ply", formats}, {.up = "y"}, std::nullopt, events.AsListener());
  EXPECT_EQ(result.extension, ".places.ply");
  EXPECT_EQ(result.sh_degree, 0);
  EXPECT_THAT(events.notes, testing::Contains(testing::HasSubstr(".places.ply has no room for a comment")));
  const GaussianPly read = ReadSplat(temp / "out.places.ply", Silent(), formats);
  ASSERT_EQ(read.gaussians.size(), 2);
  EXPECT_EQ(read.gaussians.means[1], -2) << "y of the file is up, as -y of the program is";
  EXPECT_THAT(MessageOf<UsageError>([&] { SplatFormatOf("a.b", formats); }),
              testing::HasSubstr(".usdz or .places.ply"));
}

TEST(ExportSplat, RefusesWhatScalingMakesInfinite) {
  const TempDir temp;
  Gaussians g = Row(4);
  g.means[0] = 3e38f;
  WriteGaussianPly(temp / "in.ply", g, 0);
  for (const char* name : {"out.ply", "out.sog", "out.glb"}) {
    EXPECT_THAT(MessageOf<InputError>([&] { Export(temp / "in.ply", temp / name, {.scale = 100}); }),
                testing::HasSubstr("1 of 4 Gaussians are not kept"));
    EXPECT_FALSE(std::filesystem::exists(temp / name));
  }
}

TEST(ExportSplat, AutoNeedsCameras) {
  const TempDir temp;
  WriteGaussianPly(temp / "in.ply", Row(4));
  EXPECT_THAT(MessageOf<UsageError>([&] { Export(temp / "in.ply", temp / "o.ply", {.crop = "auto"}); }),
              testing::HasSubstr("--crop auto needs; give the workspace"));
  EXPECT_THAT(MessageOf<UsageError>([&] { Export(temp / "in.ply", temp / "o.ply", {.up = "auto"}); }),
              testing::HasSubstr("--up auto needs"));
  const ExportCameras cameras{{Eigen::Vector3d(3, 0, 0), 1}, -Eigen::Vector3d::UnitY()};
  EXPECT_EQ(ExportSplat({temp / "in.ply", temp / "o.ply"}, {.crop = "auto"}, cameras, Silent()).after, 2);
}

TEST(ExportSplat, TurnedModelLooksTheSameFromATurnedCamera) {
  Gaussians g = Gaussians::Empty(200);
  uint64_t seed = 5;
  g.ForEach([&](const char*, Buffer<float>& t) { t = RandomNormal(t.shape(), seed++); });
  Flat(g.log_scales) = Flat(g.log_scales) * 0.3f - 2;
  Flat(g.sh) *= 0.3f;
  const Similarity turn{TurnBetween(Eigen::Vector3d(1, 2, -1).normalized(), Eigen::Vector3d::UnitZ()), 2, {1, 0, 3}};
  Camera camera{64, 48, 60, 60, 32, 24, LookAt({0, 0.5, -6}, {0, 0, 0}, {0, -1, 0})};
  const auto rasterizer = MakeRasterizer(kCpu);
  const RenderOptions options;
  const auto before = rasterizer->Forward(g, camera, options, RenderPass::kInference).image.Clone();
  // x_cam = R x + t of the old world; the new one's y = s Q x + u, and images do not change with the scale.
  const Eigen::Matrix3d r = camera.cam_from_world.linear();
  const Eigen::Vector3d t = camera.cam_from_world.translation();
  camera.cam_from_world.linear() = r * turn.rotation.transpose();
  camera.cam_from_world.translation() = turn.scale * t - camera.cam_from_world.linear() * turn.translation;
  const auto after = rasterizer->Forward(Transformed(g, turn), camera, options, RenderPass::kInference).image.Clone();
  EXPECT_LT((Flat(after) - Flat(before)).abs().maxCoeff(), 2e-3f);
  EXPECT_GT((Flat(before) - Flat(before).mean()).abs().maxCoeff(), 0.2f);  // there is something to see
  Gaussians unturned = Transformed(g, turn);
  unturned.sh = g.sh;
  const auto wrong = rasterizer->Forward(unturned, camera, options, RenderPass::kInference).image.Clone();
  EXPECT_GT((Flat(wrong) - Flat(before)).abs().maxCoeff(), 0.02f);  // view-dependent color has to turn too
}

TEST(CheckExport, RefusesBeforeAnythingIsRead) {
  const TempDir temp;
  WriteGaussianPly(temp / "in.ply", Row(4));
  const auto error = [&](const std::filesystem::path& to) {
    return MessageOf<UsageError>([&] { CheckExport({temp / "in.ply", to}, {}); });
  };
  EXPECT_THAT(error(temp.path()), testing::HasSubstr("is a folder; name the file to write"));
  EXPECT_THAT(error("there/"), testing::HasSubstr("is a folder; name the file to write"));
  EXPECT_THAT(error("scene.obj"), testing::HasSubstr(".compressed.ply"));
  EXPECT_THAT(error(temp / "in.ply"), testing::HasSubstr("is the input itself"));
  EXPECT_THROW(CheckExport({temp / "in.ply", temp / "a.ply"}, {.scale = 0}), UsageError);
  EXPECT_THROW(CheckExport({temp / "in.ply", temp / "a.ply"}, {.up = "q"}), UsageError);
}

}  // namespace
}  // namespace oraclegs
