#include "oraclegs/depth/align.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/golden.h"

namespace oraclegs {
namespace {

Camera Sized(int width, int height) {
  Camera camera;
  camera.width = width, camera.height = height;
  camera.fx = camera.fy = width;
  camera.cx = 0.5 * width, camera.cy = 0.5 * height;
  return camera;
}

/// The fixture: a map of another size than the camera; points outside, behind and wrong among correct ones.
struct Fixture {
  SafetensorsFile file = OpenGolden("depth_align");
  RelativeDepth map;
  Camera camera;
  std::vector<KnownDepth> known;

  Fixture() {
    const std::vector<int64_t>& shape = file.Get("mono_png16").shape;
    map.height = static_cast<int>(shape[0]), map.width = static_cast<int>(shape[1]);
    for (const int32_t value : file.Values<int32_t>("mono_png16")) {
      map.values.push_back(static_cast<float>(value) / 65535);
    }
    const std::vector<int32_t> size = file.Values<int32_t>("camera_size");
    camera = Sized(size[0], size[1]);
    const std::vector<double> xy = file.Values<double>("points_xy"), depth = file.Values<double>("points_depth");
    for (size_t i = 0; i < depth.size(); ++i) known.push_back({xy[2 * i], xy[2 * i + 1], 1 / depth[i]});
  }
  double Number(const std::string& name) const { return file.Values<double>(name)[0]; }
};

TEST(Align, MatchesPublicScripts) {
  const Fixture f;
  AlignmentRule rule;
  rule.center = 0;
  const Alignment a = Align(f.map, f.camera, f.known, rule);
  const auto near = [&](double value, const std::string& name) {
    EXPECT_NEAR(value, f.Number(name), 1e-4 * std::abs(f.Number(name))) << name;
  };
  near(a.scale, "scale");
  near(a.offset, "offset");
  near(a.known_median, "median_colmap");
  near(a.known_deviation, "mad_colmap");
  near(a.relative_median, "median_mono");
  near(a.relative_deviation, "mad_mono");
  int valid = 0;
  for (const uint8_t v : f.file.Values<uint8_t>("valid")) valid += v;
  EXPECT_EQ(a.points, valid);
  const std::vector<double> sampled = f.file.Values<double>("sampled_mono");
  const std::vector<uint8_t> is_valid = f.file.Values<uint8_t>("valid");
  const double ratio = static_cast<double>(f.map.height) / f.camera.height;
  for (size_t i = 0; i < f.known.size(); ++i) {
    if (is_valid[i] == 0) continue;
    EXPECT_NEAR(SampleAt(f.map, ratio * f.known[i].x, ratio * f.known[i].y), sampled[i], 1e-4) << i;
  }
}

TEST(Align, IsInsensitiveToHalfAPixel) {
  const Fixture f;
  AlignmentRule scripts;
  scripts.center = 0;
  const Alignment ours = Align(f.map, f.camera, f.known, {}), theirs = Align(f.map, f.camera, f.known, scripts);
  EXPECT_NEAR(ours.scale / theirs.scale, 1, 0.05);
  EXPECT_NE(ours.scale, theirs.scale);
}

TEST(SampleAt, InterpolatesAndReplicatesBorder) {
  const RelativeDepth map{3, 2, {0, 1, 2, 10, 11, 12}};
  EXPECT_EQ(SampleAt(map, 1, 0), 1);
  EXPECT_DOUBLE_EQ(SampleAt(map, 0.25, 0.5), 5.25);
  EXPECT_EQ(SampleAt(map, -3, -3), 0);
  EXPECT_EQ(SampleAt(map, 9, 9), 12);
  EXPECT_EQ(SampleAt({1, 1, {7}}, 0.3, 0.8), 7);
}

/// Points of a slope of inverse depths, which the map shows as (inverse depth - 0.1) / 3.
struct Slope {
  Camera camera = Sized(60, 40);
  RelativeDepth map{60, 40, {}};
  std::vector<KnownDepth> known;

  static double InvDepth(double x, double y) { return 0.2 + 0.01 * x + 0.002 * y; }
  Slope() {
    for (int i = 0; i < 60 * 40; ++i) {
      map.values.push_back(static_cast<float>((InvDepth(i % 60 + 0.5, i / 60 + 0.5) - 0.1) / 3));
    }
    for (int i = 0; i < 30; ++i) Add(1.5 + 1.9 * i, 3.5 + (i * 7) % 33);
  }
  void Add(double x, double y) { known.push_back({x, y, InvDepth(x, y)}); }
};

TEST(Align, FindsScaleAndOffsetDespiteOutliers) {
  Slope s;
  const Alignment right = Align(s.map, s.camera, s.known, {});
  EXPECT_NEAR(right.scale, 3, 1e-4);
  EXPECT_NEAR(right.offset, 0.1, 1e-4);
  EXPECT_NEAR(right.At(0.2), 0.7, 1e-4);
  s.known.push_back({20, 20, -3});      // behind
  s.known.push_back({-5, 20, 0.4});     // beside
  s.known.push_back({20, 40.01, 0.4});  // below
  EXPECT_EQ(Align(s.map, s.camera, s.known, {}).scale, right.scale);
  s.known.push_back({10, 10, 2 * Slope::InvDepth(10, 10)});
  EXPECT_NEAR(Align(s.map, s.camera, s.known, {}).scale, 3, 0.5);
}

TEST(Align, NeedsElevenPointsAndSpread) {
  Slope s;
  s.known.resize(11);
  EXPECT_GT(Align(s.map, s.camera, s.known, {}).scale, 0);
  std::vector<KnownDepth> ten(s.known.begin(), s.known.begin() + 10);
  EXPECT_EQ(Align(s.map, s.camera, ten, {}).scale, 0);
  EXPECT_EQ(Align(s.map, s.camera, {}, {}).points, 0);
  RelativeDepth flat = s.map;
  flat.values.assign(flat.values.size(), 0.3f);
  EXPECT_EQ(Align(flat, s.camera, s.known, {}).scale, 0);
  for (size_t i = 0; i < s.known.size(); ++i) s.known[i].inv_depth = 0.5 + 9e-5 * static_cast<double>(i);
  const Alignment narrow = Align(s.map, s.camera, s.known, {});
  EXPECT_EQ(narrow.scale, 0);
  EXPECT_EQ(narrow.offset, 0);
  AlignmentRule finer;
  finer.min_span = 1e-4;
  EXPECT_GT(Align(s.map, s.camera, s.known, finer).scale, 0);
}

TEST(AreReliable, AcceptsFactorOfFiveAroundMedian) {
  const auto of = [](std::vector<double> scales) {
    std::vector<Alignment> alignments;
    for (const double scale : scales) {
      alignments.emplace_back();
      alignments.back().scale = scale;
    }
    return AreReliable(alignments);
  };
  EXPECT_EQ(of({1, 1, 0.19, 0.2, 5, 5.1, 0, 1}),
            std::vector<bool>({true, true, false, true, true, false, false, true}));
  EXPECT_EQ(of({0, 0}), std::vector<bool>({false, false}));
  EXPECT_EQ(of({1, 3}), std::vector<bool>({true, true})) << "the median is 2";
  EXPECT_TRUE(of({}).empty());
}

TEST(KnownDepths, ProjectsPointsOfView) {
  Camera camera = Sized(60, 40);
  camera.cam_from_world.translation() = Eigen::Vector3d(0, 0, 1);
  std::vector<ScenePoint> points(3);
  points[0] = {{0.5, 0.25, 1}, {}, {0, 2}};
  points[1] = {{0, 0, 3}, {}, {1}};
  points[2] = {{0, 0, -2}, {}, {2}};
  const std::vector<KnownDepth> known = KnownDepths(points, 2, camera);
  ASSERT_EQ(known.size(), 2u);
  EXPECT_DOUBLE_EQ(known[0].x, 45);
  EXPECT_DOUBLE_EQ(known[0].y, 27.5);
  EXPECT_DOUBLE_EQ(known[0].inv_depth, 0.5);
  EXPECT_DOUBLE_EQ(known[1].inv_depth, -1) << "behind";
}

TEST(MinSpan, ScalesWithScene) {
  EXPECT_DOUBLE_EQ(MinSpan({{{0, 0, 2}, {0, 0, -5}}, {{0, 0, 4}, {0, 0, 300}}}), 4e-3);
  EXPECT_EQ(MinSpan({{}, {{0, 0, -1}}}), 0);
}

}  // namespace
}  // namespace oraclegs
