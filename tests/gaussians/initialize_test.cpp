#include "oraclegs/gaussians/initialize.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "oraclegs/camera/scene_bounds.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "support/buffers.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

Camera LookAt(const Eigen::Vector3d& eye, const Eigen::Vector3d& target) {
  Camera camera;
  camera.width = 200, camera.height = 150;
  camera.fx = camera.fy = 180;
  camera.cx = 100, camera.cy = 75;
  const Eigen::Vector3d z = (target - eye).normalized();
  const Eigen::Vector3d x = Eigen::Vector3d(0.1, -1, 0.05).cross(z).normalized();
  Eigen::Matrix3d r;
  r << x.transpose(), z.cross(x).transpose(), z.transpose();
  camera.cam_from_world.linear() = r;
  camera.cam_from_world.translation() = -(r * eye);
  return camera;
}

std::vector<Camera> Ring(int n, double radius, const Eigen::Vector3d& center) {
  std::vector<Camera> cameras;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * M_PI * i / n;
    cameras.push_back(LookAt(center + radius * Eigen::Vector3d(std::cos(angle), 0.3, std::sin(angle)), center));
  }
  return cameras;
}

int Seen(const std::vector<Camera>& cameras, const Eigen::Vector3f& point) {
  int seen = 0;
  for (const Camera& c : cameras) {
    const Eigen::Vector3d p = c.cam_from_world * point.cast<double>();
    const double x = c.fx * p.x() / p.z() + c.cx, y = c.fy * p.y() / p.z() + c.cy;
    seen += p.z() > 0 && x > -1e-3 && x < c.width + 1e-3 && y > -1e-3 && y < c.height + 1e-3 ? 1 : 0;
  }
  return seen;
}

TEST(ToPointCloud, ScalesColors) {
  ScenePoint point;
  point.xyz = {1, 2, 3};
  point.rgb = {255, 0, 51};
  const PointCloud cloud = ToPointCloud({point});
  ASSERT_EQ(cloud.xyz.size(), 1u);
  EXPECT_EQ(cloud.xyz[0], Eigen::Vector3f(1, 2, 3));
  EXPECT_TRUE(cloud.rgb[0].isApprox(Eigen::Vector3f(1, 0, 0.2f)));
}

TEST(RandomPointsInBlenderCube, FillsTheCubeForASeed) {
  const PointCloud cloud = RandomPointsInBlenderCube(4000, 5);
  Eigen::Array3f low = cloud.xyz[0], high = low;
  for (size_t i = 0; i < cloud.xyz.size(); ++i) {
    low = low.min(cloud.xyz[i].array());
    high = high.max(cloud.xyz[i].array());
    EXPECT_LT((cloud.rgb[i].array() - 0.5f).abs().maxCoeff(), 0.01f);
  }
  EXPECT_TRUE((low >= -1.3f).all() && (low < -1.28f).all() && (high <= 1.3f).all() && (high > 1.28f).all());
  EXPECT_EQ(RandomPointsInBlenderCube(4000, 5).xyz, cloud.xyz);
  EXPECT_NE(RandomPointsInBlenderCube(4000, 6).xyz, cloud.xyz);
}

TEST(RandomPointsInCube, FillsThreeTimesTheExtentAroundTheOrigin) {
  const std::vector<Camera> cameras = Ring(6, 2, {10, -3, 4});
  const auto half = static_cast<float>(3 * SpatialExtent(cameras));
  const PointCloud cloud = RandomPointsInCube(cameras, 4000, 5);
  Eigen::Array3f low = cloud.xyz[0], high = low;
  for (const auto& point : cloud.xyz) low = low.min(point.array()), high = high.max(point.array());
  EXPECT_TRUE((low >= -half).all() && (low < -0.98f * half).all());
  EXPECT_TRUE((high <= half).all() && (high > 0.98f * half).all());
  EXPECT_EQ(RandomPointsInCube(cameras, 4000, 5).xyz, cloud.xyz);
}

TEST(RandomPointsInView, IsSeenByTwoCameras) {
  const Eigen::Vector3d center(10, -3, 4);
  const std::vector<Camera> cameras = Ring(6, 3, center);
  const PointCloud cloud = RandomPointsInView(cameras, 3000, 1);
  ASSERT_EQ(cloud.xyz.size(), 3000u);
  ASSERT_EQ(cloud.rgb.size(), 3000u);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& p : cloud.xyz) {
    EXPECT_GE(Seen(cameras, p), 2);
    for (const Camera& c : cameras) EXPECT_GT((c.Center() - p.cast<double>()).norm(), 0.2 * 3);
    mean += p.cast<double>() / 3000;
  }
  EXPECT_LT((mean - center).norm(), 0.5);
  EXPECT_EQ(RandomPointsInView(cameras, 3000, 1).xyz, cloud.xyz);
  EXPECT_NE(RandomPointsInView(cameras, 3000, 2).xyz, cloud.xyz);
}

TEST(RandomPointsInView, LiesInFrontOfParallelCameras) {
  std::vector<Camera> cameras;
  for (int i = 0; i < 5; ++i) cameras.push_back(LookAt({0.2 * i, 0, 0}, {0.2 * i, 0, 1}));
  for (const auto& p : RandomPointsInView(cameras, 500, 3).xyz) {
    EXPECT_GT(p.z(), 0);
    EXPECT_GE(Seen(cameras, p), 2);
  }
}

TEST(RandomPointsInView, NeedsOneViewWithoutOverlap) {
  const std::vector<Camera> one = {LookAt({1, 2, 3}, {1, 2, 9})};
  for (const auto& p : RandomPointsInView(one, 300, 4).xyz) EXPECT_EQ(Seen(one, p), 1);
  // A rig that looks outward: the axes meet behind every camera.
  std::vector<Camera> outward;
  for (const Camera& c : Ring(3, 1, {0, 0, 0})) {
    outward.push_back(LookAt(c.Center(), 5 * c.Center()));
  }
  const PointCloud cloud = RandomPointsInView(outward, 300, 4);
  ASSERT_EQ(cloud.xyz.size(), 300u);
  for (const auto& p : cloud.xyz) EXPECT_GE(Seen(outward, p), 1);
}

TEST(RandomPointsInView, RefusesNoCameras) { EXPECT_THROW(RandomPointsInView({}, 10, 0), std::invalid_argument); }

TEST(MeanSquaredNeighborDistance, HasAMinimumAndRefusesNan) {
  EXPECT_EQ(MeanSquaredNeighborDistance({{0, 0, 0}, {2, 0, 0}}), (std::vector<float>{4, 4}));
  EXPECT_EQ(MeanSquaredNeighborDistance({{3, 3, 3}}), std::vector<float>{1e-7f});
  EXPECT_EQ(MeanSquaredNeighborDistance({{3, 3, 3}, {3, 3, 3}}), (std::vector<float>{1e-7f, 1e-7f}));
  EXPECT_TRUE(MeanSquaredNeighborDistance({}).empty());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(MeanSquaredNeighborDistance({{0, nan, 0}, {1, 1, 1}}), std::invalid_argument);
  const float huge = 3e38f;
  for (const float d2 : MeanSquaredNeighborDistance({{huge, 0, 0}, {-huge, 0, 0}})) EXPECT_TRUE(std::isfinite(d2));
}

TEST(MeanSquaredNeighborDistance, RefusesAnUnusableDevice) {
  EXPECT_THROW(MeanSquaredNeighborDistance({{0, 0, 0}, {2, 0, 0}}, Device{DeviceKind::kCuda, 99}), UsageError);
}

TEST(InitializeGaussians, SetsAllParameters) {
  PointCloud cloud;
  cloud.xyz = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
  cloud.rgb = {{1, 0.5f, 0}, {0, 0, 0}, {1, 1, 1}, {0.25f, 0.5f, 0.75f}};
  const Gaussians g = InitializeGaussians(cloud, {});
  g.Check("test");
  ASSERT_EQ(g.size(), 4);
  // The origin's three others are at 1, 2 and 3.
  const double expected = std::log(0.1 * std::sqrt((1.0 + 4 + 9) / 3));
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(g.log_scales[k], expected, 1e-6);
  EXPECT_EQ(g.means[3 * 3 + 2], 3);
  EXPECT_EQ(MaxAbs(g.opacity_logits), 0);
  EXPECT_TRUE(Equal(g.quats.Rows(2, 3), Buffer<float>::From({1, 4}, {1, 0, 0, 0})));
  EXPECT_NEAR(g.sh[0], 0.5 / 0.28209479177387814, 1e-6);
  EXPECT_NEAR(g.sh[1], 0, 1e-6);
  EXPECT_NEAR(g.sh[3 * kShFloats], -0.25 / 0.28209479177387814, 1e-6);
  EXPECT_TRUE((Table(g.sh).rightCols(kShFloats - 3) == 0).all());
}

TEST(InitializeGaussians, UsesScaleAndOpacityOptions) {
  PointCloud cloud;
  cloud.xyz = {{0, 0, 0}, {2, 0, 0}};
  cloud.rgb.resize(2, {0.5f, 0.5f, 0.5f});
  InitializeOptions options;
  options.scale_factor = 1;
  options.opacity = 0.1;
  const Gaussians g = InitializeGaussians(cloud, options);
  EXPECT_NEAR(g.log_scales[0], std::log(2.0), 1e-6);
  EXPECT_NEAR(1 / (1 + std::exp(-g.opacity_logits[1])), 0.1, 1e-6);
  EXPECT_EQ(InitializeGaussians({}, {}).size(), 0);
  cloud.rgb.pop_back();
  EXPECT_THROW(InitializeGaussians(cloud, {}), ShapeError);
}

TEST(ReadPointPly, TakesColorsOfEitherKindOrNone) {
  const TempDir temp;
  const auto read = [&](const std::string& colors, const std::string& rows) {
    WriteFileAtomically(temp / "p.ply",
                        "ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\nproperty float y\n"
                        "property float z\nproperty float confidence\n" +
                            colors + "end_header\n" + rows);
    return ReadPointPly(temp / "p.ply");
  };
  const std::string bytes = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  const std::string numbers = "property float red\nproperty float green\nproperty float blue\n";
  const PointCloud of_bytes = read(bytes, "1 2 3 0 255 0 51\nnan 0 0 0 1 1 1\n");
  ASSERT_EQ(of_bytes.xyz.size(), 1u) << "one is not finite";
  EXPECT_EQ(of_bytes.xyz[0], Eigen::Vector3f(1, 2, 3));
  EXPECT_TRUE(of_bytes.rgb[0].isApprox(Eigen::Vector3f(1, 0, 0.2f)));
  EXPECT_TRUE(read(numbers, "1 2 3 0 0.5 7 -1\n0 0 0 0 1 1 1\n").rgb[0].isApprox(Eigen::Vector3f(0.5f, 1, 0)));
  EXPECT_EQ(read("", "1 2 3 0\n0 0 0 0\n").rgb[1], Eigen::Vector3f::Constant(0.5f));
  EXPECT_THROW(read("", "1 2 3 0\n"), InputError);
}

}  // namespace
}  // namespace oraclegs
