#include "bench/gpu_stereo.h"

#include <utility>

#include "depth/surfaces.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/progress.h"
#include "oraclegs/depth/stereo.h"
#include "oraclegs/train/timings.h"

namespace oraclegs {
namespace {

constexpr int kPhotographs = 6;
constexpr double kStep = 8;  // degrees between neighbouring cameras

/// Another search, and the seconds spent in it.
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

GpuStereo MeasureStereo(int width, int height, PlaneSearch* search) {
  const TexturedPlane surface{{0, 0, 0.3}, Eigen::Vector3d(0.5, -0.3, -1).normalized()};
  const std::vector<Camera> cameras = Arc(kPhotographs, kStep, width, height);
  std::vector<LoadedView> photos(kPhotographs);
  ParallelFor(kPhotographs, [&](int64_t v) {
    const auto i = static_cast<size_t>(v);
    photos[i] = surface.Take(cameras[i], std::to_string(i));
  });
  GpuStereo times;
  for (int run = 0; run < 2; ++run) {
    TimedSearch timed(search);
    const Stopwatch watch;
    EstimateDepth(photos, {}, StereoOptions(), &timed, Silent());
    times.seconds = watch.Seconds() / kPhotographs;
    times.search_seconds = timed.seconds() / kPhotographs;
  }
  return times;
}

}  // namespace oraclegs
