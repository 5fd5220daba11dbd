#include "bench/gpu_once.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "depth/surfaces.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/progress.h"
#include "oraclegs/core/rng.h"
#include "oraclegs/core/statistics.h"
#include "oraclegs/depth/stereo.h"
#include "oraclegs/gaussians/cuda/neighbors.h"
#include "oraclegs/gaussians/neighbors.h"
#include "oraclegs/propose/warp.h"
#include "oraclegs/propose/warp_device.h"
#include "oraclegs/train/timings.h"

namespace oraclegs {
namespace {

constexpr uint64_t kSeed = 3;
constexpr double kStep = 0.05;       // radians between warped cameras
constexpr double kWrongShare = 0.2;  // of the depths, by up to a tenth
constexpr double kDistance = 4;      // of the cameras from the plane z = 0, in which everything lies
constexpr float kConfidence = 0.9f;  // of every depth
constexpr int kStereoImages = 6;
constexpr double kStereoStep = 8;  // degrees between neighboring cameras

template <class Body>
double Milliseconds(int passes, const Body& body) {
  std::vector<double> times;
  for (int i = 0; i < passes; ++i) {
    const Stopwatch watch;
    body();
    times.push_back(watch.Seconds() * 1e3);
  }
  return UpperMedian(times);
}

Camera OnArc(const WarpSize& size, double angle) {
  return CameraAt({kDistance * std::sin(angle), 0, -kDistance * std::cos(angle)}, {0, 0, 0}, size.width, size.height);
}

/// Source with random colors and the depth of the plane.
std::pair<LoadedView, DepthMap> RandomSource(const Camera& camera, Rng* rng) {
  const size_t pixels = static_cast<size_t>(camera.width) * static_cast<size_t>(camera.height);
  LoadedView view{"v", camera, {camera.width, camera.height, 3, std::vector<float>(3 * pixels)}, {}};
  DepthMap map{"v", camera, std::vector<float>(pixels), {}, std::vector<float>(pixels, kConfidence)};
  const Eigen::Vector3d towards = camera.cam_from_world.linear().col(2) / -camera.Center().z();
  for (size_t i = 0; i < pixels; ++i) {
    const double u = static_cast<double>(i % static_cast<size_t>(camera.width)) + 0.5;
    const double v = static_cast<double>(i / static_cast<size_t>(camera.width)) + 0.5;
    const Eigen::Vector3d ray((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1);
    const double factor = rng->Uniform() < kWrongShare ? rng->Uniform(0.9, 1.1) : 1;
    map.inv_depth[i] = static_cast<float>(factor * towards.dot(ray));
    for (size_t c = 0; c < 3; ++c) view.rgb.data[3 * i + c] = static_cast<float>((i >> (2 * c)) % 256) / 255;
  }
  return {std::move(view), std::move(map)};
}

/// Wrapper of a search that sums the seconds spent in it.
class TimedSearch final : public PlaneSearch {
 public:
  explicit TimedSearch(PlaneSearch* search) : search_(*search) {}

  void BeginLevel(const StereoScene& scene, std::vector<PlaneMap> maps) override {
    const Stopwatch watch;
    search_.BeginLevel(scene, std::move(maps));
    seconds_ += watch.Seconds();
  }
  void BeginPass(const SearchPass& pass) override {
    const Stopwatch watch;
    search_.BeginPass(pass);
    seconds_ += watch.Seconds();
  }
  void Improve(size_t view) override {
    const Stopwatch watch;
    search_.Improve(view);
    seconds_ += watch.Seconds();
  }
  std::vector<PlaneMap> EndLevel() override {
    const Stopwatch watch;
    std::vector<PlaneMap> maps = search_.EndLevel();
    seconds_ += watch.Seconds();
    return maps;
  }
  double seconds() const { return seconds_; }

 private:
  PlaneSearch& search_;
  double seconds_ = 0;
};

}  // namespace

OnBoth MeasureNeighbors(int64_t count, int passes) {
  Rng rng(kSeed, RandomStream::kInitialPoints);
  std::vector<Eigen::Vector3f> points(static_cast<size_t>(count));
  for (Eigen::Vector3f& p : points) {
    for (int axis = 0; axis < 3; ++axis) p[axis] = static_cast<float>(rng.Uniform(-1, 1));
  }
  return {Milliseconds(passes, [&] { cuda::MeanSquaredDistanceToThree(points); }),
          Milliseconds(1, [&] { KdTree(points).MeanSquaredDistanceToThree(); })};
}

OnBoth MeasureWarp(const WarpSize& size, int passes) {
  Rng rng(kSeed, RandomStream::kInitialPoints);
  std::vector<LoadedView> views;
  std::vector<DepthMap> maps;
  for (int i = 0; i < size.images; ++i) {
    auto [view, map] = RandomSource(OnArc(size, kStep * (i - size.images / 2)), &rng);
    views.push_back(std::move(view));
    maps.push_back(std::move(map));
  }
  const WarpSources sources{views, maps};
  const Warper on_gpu(sources, cuda::MakeCudaWarpDevice(sources, 0)), on_cpu(sources);
  const Camera between = OnArc(size, kStep / 2);
  return {Milliseconds(passes, [&] { on_gpu.Warp(between); }), Milliseconds(1, [&] { on_cpu.Warp(between); })};
}

GpuStereo MeasureStereo(int width, int height, PlaneSearch* search) {
  const TexturedPlane surface{{0, 0, 0.3}, Eigen::Vector3d(0.5, -0.3, -1).normalized()};
  const std::vector<Camera> cameras = Arc(kStereoImages, kStereoStep, width, height);
  std::vector<LoadedView> views(kStereoImages);
  ParallelFor(kStereoImages, [&](int64_t v) {
    const auto i = static_cast<size_t>(v);
    views[i] = surface.Take(cameras[i], std::to_string(i));
  });
  GpuStereo times;
  for (int run = 0; run < 2; ++run) {
    TimedSearch timed(search);
    const Stopwatch watch;
    EstimateDepth(views, {}, StereoOptions(), &timed, Silent());
    times.seconds = watch.Seconds() / kStereoImages;
    times.search_seconds = timed.seconds() / kStereoImages;
  }
  return times;
}

std::string OnBothText(const std::string& what, const OnBoth& times) {
  return fmt::format("{}: {:.1f} ms, on the CPU {:.0f} ms\n", what, times.gpu, times.cpu);
}

std::string StereoText(const GpuStereo& times) {
  return fmt::format("stereo: {:.3f} s an image, {:.3f} s of it the search on the GPU\n", times.seconds,
                     times.search_seconds);
}

nlohmann::json OnBothToJson(const std::string& name, const OnBoth& times) {
  return {{name + "_ms", times.gpu}, {name + "_cpu_ms", times.cpu}};
}

nlohmann::json StereoToJson(const GpuStereo& times) {
  return {{"stereo_seconds", times.seconds}, {"stereo_search_seconds", times.search_seconds}};
}

}  // namespace oraclegs
