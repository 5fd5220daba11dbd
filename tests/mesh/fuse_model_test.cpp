#include "oraclegs/mesh/fuse_model.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mesh/views_of_shapes.h"
#include "support/errors.h"
#include "support/event_recorder.h"

namespace oraclegs {
namespace {

/// Flat Gaussians of one color all over a sphere of radius 1 around the origin.
Gaussians Ball(int count) {
  Gaussians ball = Gaussians::Zeros(count);
  const GaussianRows all = ball.Rows();
  for (int i = 0; i < count; ++i) {
    const GaussianRows row = all.From(i);
    const double z = 1 - 2 * (i + 0.5) / count, a = i * 2.39996323, r = std::sqrt(1 - z * z);
    const Eigen::Vector3d at(r * std::cos(a), r * std::sin(a), z);
    const auto turn = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), at);
    for (int c = 0; c < 3; ++c) row.means[c] = static_cast<float>(at[c]);
    row.quats[0] = static_cast<float>(turn.w());
    for (int c = 0; c < 3; ++c) row.quats[1 + c] = static_cast<float>(turn.vec()[c]);
    const double size = 0.6 * std::sqrt(4 * 3.14159265 / count);
    row.log_scales[0] = row.log_scales[1] = static_cast<float>(std::log(size));
    row.log_scales[2] = static_cast<float>(std::log(size / 50));
    row.opacity_logits[0] = 4;
    row.sh[0] = 1;  // red 0.78
  }
  return ball;
}

TEST(FuseModel, MakesABallOfItsColor) {
  SKIP_WITHOUT_OPENVDB();
  EventRecorder recorder;
  MeshOptions options;
  options.renders = 20;
  const FusedMesh fused = FuseModel(Ball(3000), {}, ShapeCamerasAround(3), options, recorder.AsListener());
  ASSERT_GT(fused.mesh.triangles.size(), 500u);
  EXPECT_NEAR(fused.voxel, 2.3 / 96, 0.5 / 96) << "what a pixel covers";
  EXPECT_EQ(fused.truncation, 4 * fused.voxel);
  double error = 0;
  for (size_t i = 0; i < fused.mesh.positions.size(); ++i) {
    error += std::abs(fused.mesh.positions[i].norm() - 1) / static_cast<double>(fused.mesh.positions.size());
    EXPECT_NEAR(fused.mesh.colors[i][0], 255 * 0.782, 12);
    EXPECT_NEAR(fused.mesh.colors[i][1], 255 * 0.5, 10);
  }
  EXPECT_LT(error, 1.5 * fused.voxel);
  ASSERT_FALSE(recorder.steps.empty());
  EXPECT_EQ(recorder.steps.back().done, recorder.steps.back().total);
}

TEST(FuseModel, MultipliesByTheUnit) {
  SKIP_WITHOUT_OPENVDB();
  MeshOptions options;
  options.renders = 20;
  options.voxel = 0.5;  // 0.05 of the scene's units
  options.unit = 10;
  const FusedMesh fused = FuseModel(Ball(3000), {}, ShapeCamerasAround(3), options, Silent());
  EXPECT_NEAR(fused.voxel, 0.5, 1e-9);
  ASSERT_FALSE(fused.mesh.positions.empty());
  for (const Eigen::Vector3f& position : fused.mesh.positions) EXPECT_NEAR(position.norm(), 10, 1);
}

TEST(FuseModel, MakesFewTrianglesWithATexture) {
  SKIP_WITHOUT_OPENVDB();
  MeshOptions options;
  options.renders = 20;
  options.triangles = 500;
  options.texture = 1024;
  const TriangleMesh mesh = FuseModel(Ball(3000), {}, ShapeCamerasAround(3), options, Silent()).mesh;
  EXPECT_LE(mesh.triangles.size(), 500u);
  EXPECT_GT(mesh.triangles.size(), 400u);
  ASSERT_EQ(mesh.texcoords.size(), mesh.positions.size());
  for (const Eigen::Vector2f& at : mesh.texcoords) {
    const auto side = static_cast<size_t>(mesh.texture.width);
    const size_t texel = static_cast<size_t>(at.y() * static_cast<float>(side)) * side +
                         static_cast<size_t>(at.x() * static_cast<float>(side));
    EXPECT_NEAR(mesh.texture.data[3 * texel], 255 * 0.782, 14);
  }
}

TEST(FuseModel, RefusesANumberOfTrianglesThatShowsNothing) {
  MeshOptions options;
  options.triangles = 1;
  EXPECT_THAT(MessageOf<UsageError>([&] { CheckMesh(options); }), testing::HasSubstr("--triangles is 1, must be 0"));
  options.triangles = 0;
  options.texture = kMaxTextureSide + 1;
  EXPECT_THAT(MessageOf<UsageError>([&] { CheckMesh(options); }), testing::HasSubstr("texture"));
}

TEST(FuseModel, NamesAVoxelThatTheRendersHold) {
  SKIP_WITHOUT_OPENVDB();
  MeshOptions options;
  options.voxel = 1e-5;
  const std::vector<Camera> cameras = {ShapeCamera({3, 0, 0}, {0, 0, 0})};
  const auto message = [&] {
    return MessageOf<UsageError>([&] { FuseModel(Ball(500), {}, cameras, options, Silent()); });
  };
  EXPECT_THAT(message(), testing::HasSubstr("--voxel is 1e-05: the renders hold no such detail"));
  options.voxel = 0.05;
  for (const double truncation : {0.01, 5.0}) {
    options.truncation = truncation;
    EXPECT_THAT(message(), testing::HasSubstr("--trunc"));
  }
}

TEST(FuseModel, OfNothingIsEmpty) {
  SKIP_WITHOUT_OPENVDB();
  Gaussians faint = Ball(100);
  for (float& logit : faint.opacity_logits.span()) logit = -12;
  EXPECT_TRUE(FuseModel(faint, {}, ShapeCamerasAround(3), {}, Silent()).mesh.triangles.empty());
}

TEST(MeshCameras, AddsSomeBetweenTheOthers) {
  const auto ring = ShapeCamerasAround(3);
  const std::vector<Camera> cameras(ring.begin(), ring.begin() + 4);
  const auto all = MeshCameras(cameras, 10);
  ASSERT_EQ(all.size(), 10u);
  for (const Camera& camera : all) {
    EXPECT_NO_THROW(camera.Check("between"));
    EXPECT_NEAR(camera.Center().norm(), 3, 0.3);
  }
  EXPECT_EQ(MeshCameras(cameras, 2).size(), 4u);
  EXPECT_EQ(MeshCameras({cameras[0]}, 5).size(), 1u);
}

}  // namespace
}  // namespace oraclegs
