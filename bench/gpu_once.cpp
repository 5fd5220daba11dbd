#include "bench/gpu_once.h"

#include <fmt/format.h>

#include "bench/median.h"
#include "depth/rig.h"
#include "oraclegs/core/rng.h"
#include "oraclegs/gaussians/cuda/neighbors.h"
#include "oraclegs/gaussians/neighbors.h"
#include "oraclegs/propose/cuda/cuda_warp_device.h"
#include "oraclegs/train/timings.h"

namespace oraclegs {
namespace {

constexpr uint64_t kSeed = 3;
constexpr double kStep = 0.05;   // radians between photographs
constexpr double kUnsure = 0.2;  // share of the depths that are wrong by up to a tenth
constexpr double kDistance = 4;  // of the cameras from the plane z = 0, in which everything lies
constexpr float kConfidence = 0.9f;

template <class Body>
double Milliseconds(int passes, const Body& body) {
  std::vector<double> times;
  for (int i = 0; i < passes; ++i) {
    const Stopwatch watch;
    body();
    times.push_back(watch.Seconds() * 1e3);
  }
  return Median(times);
}

Camera OnArc(const GpuScene& scene, double angle) {
  return CameraAt({kDistance * std::sin(angle), 0, -kDistance * std::cos(angle)}, {0, 0, 0}, scene.width, scene.height);
}

/// Any colours; depth of the plane.
void Take(const Camera& camera, Rng* rng, std::vector<LoadedView>* photos, std::vector<DepthMap>* maps) {
  const size_t pixels = static_cast<size_t>(camera.width) * static_cast<size_t>(camera.height);
  LoadedView photo{"p", camera, {camera.width, camera.height, 3, std::vector<float>(3 * pixels)}, {}};
  DepthMap map{"p", camera, std::vector<float>(pixels), {}, std::vector<float>(pixels, kConfidence)};
  const Eigen::Vector3d towards = camera.cam_from_world.linear().col(2) / -camera.Center().z();
  for (size_t i = 0; i < pixels; ++i) {
    const double u = static_cast<double>(i % static_cast<size_t>(camera.width)) + 0.5;
    const double v = static_cast<double>(i / static_cast<size_t>(camera.width)) + 0.5;
    const Eigen::Vector3d ray((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1);
    const double wrong = rng->Uniform() < kUnsure ? rng->Uniform(0.9, 1.1) : 1;
    map.inv_depth[i] = static_cast<float>(wrong * towards.dot(ray));
    for (size_t c = 0; c < 3; ++c) photo.rgb.data[3 * i + c] = static_cast<float>((i >> (2 * c)) % 256) / 255;
  }
  photos->push_back(std::move(photo));
  maps->push_back(std::move(map));
}

OnBoth TimeNeighbors(const GpuScene& scene, int passes) {
  Rng rng(kSeed, RandomStream::kInitialPoints);
  std::vector<Eigen::Vector3f> points(static_cast<size_t>(scene.gaussians));
  for (Eigen::Vector3f& p : points) {
    for (int axis = 0; axis < 3; ++axis) p[axis] = static_cast<float>(rng.Uniform(-1, 1));
  }
  return {Milliseconds(passes, [&] { cuda::MeanSquaredDistanceToThree(points); }),
          Milliseconds(1, [&] { KdTree(points).MeanSquaredDistanceToThree(); })};
}

OnBoth TimeWarp(const GpuScene& scene, int photographs, int passes) {
  Rng rng(kSeed, RandomStream::kInitialPoints);
  std::vector<LoadedView> photos;
  std::vector<DepthMap> maps;
  for (int i = 0; i < photographs; ++i) Take(OnArc(scene, kStep * (i - photographs / 2)), &rng, &photos, &maps);
  const WarpSources sources{photos, maps};
  const Warper on_gpu(sources, cuda::MakeCudaWarpDevice(sources, 0)), on_cpu(sources);
  const Camera between = OnArc(scene, kStep / 2);
  return {Milliseconds(passes, [&] { on_gpu.Warp(between, -1); }), Milliseconds(1, [&] { on_cpu.Warp(between, -1); })};
}

}  // namespace

GpuOnce MeasureOnce(const GpuScene& scene, int photographs, int passes) {
  return {static_cast<double>(scene.gaussians), static_cast<double>(photographs), TimeNeighbors(scene, passes),
          TimeWarp(scene, photographs, passes)};
}

std::string OnceText(const GpuOnce& once) {
  return fmt::format(
      "three nearest neighbours of {:.0f} points: {:.1f} ms, on the CPU {:.0f} ms\n"
      "a view warped from {:.0f} photographs: {:.1f} ms, on the CPU {:.0f} ms\n",
      once.points, once.neighbors.gpu, once.neighbors.cpu, once.photographs, once.warp.gpu, once.warp.cpu);
}

}  // namespace oraclegs
