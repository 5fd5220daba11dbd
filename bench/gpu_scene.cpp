#include "bench/gpu_scene.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "oraclegs/camera/undistort.h"
#include "oraclegs/gaussians/ply.h"
#include "oraclegs/scene/transforms_frame.h"
#include "render/scenes.h"

namespace oraclegs {
namespace {

constexpr uint64_t kSceneSeed = 1;
constexpr double kScale = 0.008;  // world units: about four tiles a Gaussian
constexpr size_t kViews = 3;
constexpr double kCameraStep = 0.02;  // world units between the synthetic cameras

Camera AtPixels(const Camera& camera, int64_t pixels) {
  const double factor = std::sqrt(static_cast<double>(pixels) / (static_cast<double>(camera.width) * camera.height));
  const auto scaled = [&](int length) { return std::max(1, static_cast<int>(std::lround(factor * length))); };
  return Resized(camera, scaled(camera.width), scaled(camera.height));
}

}  // namespace

GpuScene SyntheticScene(int64_t gaussians, int width, int height) {
  GpuScene scene{RandomGaussians(gaussians, kScale, kSceneSeed), {}};
  for (size_t i = 0; i < kViews; ++i) {
    Camera camera = FrontCamera(width, height);
    camera.cam_from_world.translation().x() = kCameraStep * static_cast<double>(i);
    scene.cameras.push_back(camera);
  }
  return scene;
}

GpuScene TrainedScene(const std::filesystem::path& ply, const std::filesystem::path& transforms, int64_t pixels) {
  GpuScene scene{ReadGaussianPly(ply).gaussians, {}};
  const nlohmann::json file = ReadTransformsFile(transforms);
  for (const nlohmann::json& entry : file["frames"]) {
    if (scene.cameras.size() == kViews) break;
    const auto [frame, name] = NamedFrame(file, entry, transforms, static_cast<int>(scene.cameras.size()));
    Camera camera = UndistortedCamera(ReadTransformsIntrinsics(frame, FindFrameImage(transforms.parent_path(), name)));
    camera.cam_from_world = ReadTransformsPose(frame).cam_from_world;
    scene.cameras.push_back(AtPixels(camera, pixels));
  }
  return scene;
}

}  // namespace oraclegs
