#include "oraclegs/propose/warp_device.h"

#include <algorithm>
#include <memory>

#include "oraclegs/core/cuda_library.h"
#include "oraclegs/core/error.h"
#include "oraclegs/propose/warp_shading.h"

namespace oraclegs {
namespace {

/// Samples of each pixel, pixel by pixel.
struct SampleLists {
  std::vector<size_t> begin;  ///< begin of each pixel's samples, and the end of all
  std::unique_ptr<WarpSample[]> samples;
};

SampleLists Splat(const WarpScene& scene) {
  SampleLists lists;
  lists.begin.assign(scene.pixels() + 1, 0);
  const auto each = [&](const auto& take) {
    for (int k = 0; k < scene.count; ++k) {
      const WarpSource& from = scene.sources[k];
      const float* confidence = from.confidence;
      for (int y = 0; y < from.height; ++y) {
        for (int x = 0; x < from.width; ++x, ++confidence) {
          const DepthSplat splat = SplatOf(scene, from, x, y);
          if (splat.right < splat.left) continue;
          const WarpSample sample = SampleOf(splat.inv_depth, k, *confidence);
          for (int ty = splat.top; ty <= splat.bottom; ++ty) {
            for (int tx = splat.left; tx <= splat.right; ++tx) {
              take(static_cast<size_t>(ty) * static_cast<size_t>(scene.width) + static_cast<size_t>(tx), sample);
            }
          }
        }
      }
    }
  };
  each([&](size_t pixel, const WarpSample&) { ++lists.begin[pixel + 1]; });
  for (size_t i = 1; i < lists.begin.size(); ++i) lists.begin[i] += lists.begin[i - 1];
  lists.samples = std::make_unique_for_overwrite<WarpSample[]>(lists.begin.back());
  std::vector<size_t> next(lists.begin.begin(), lists.begin.end() - 1);
  each([&](size_t pixel, const WarpSample& sample) { lists.samples[next[pixel]++] = sample; });
  return lists;
}

/// Largest weight of each source among a surface's samples.
class CountedVotes {
 public:
  explicit CountedVotes(int sources) : votes_(static_cast<size_t>(sources)) {}

  void Count(const WarpSample* begin, const WarpSample* end) {
    std::fill(votes_.begin(), votes_.end(), 0.f);
    for (const WarpSample* s = begin; s < end; ++s) {
      votes_[s->source] = std::max(votes_[s->source], static_cast<float>(s->weight) / kFullWeight);
    }
  }
  float Of(int source) const { return votes_[static_cast<size_t>(source)]; }

 private:
  std::vector<float> votes_;
};

/// Warps on the CPU, one pixel after another: callers warp several views at once.
class CpuWarpDevice : public WarpDevice {
 public:
  WarpDepth FindSurfaces(const WarpTask& task) override {
    const WarpScene scene = SceneOf(task);
    const SampleLists lists = Splat(scene);
    WarpDepth depth{std::vector<float>(scene.pixels(), 0.f), std::vector<uint8_t>(scene.pixels(), 0)};
    CountedVotes votes(scene.count);
    for (size_t i = 0; i < scene.pixels(); ++i) {
      WarpSample *begin = lists.samples.get() + lists.begin[i], *end = lists.samples.get() + lists.begin[i + 1];
      std::sort(begin, end, [](const WarpSample& a, const WarpSample& b) {
        return a.inv_depth != b.inv_depth ? a.inv_depth > b.inv_depth : a.source < b.source;
      });
      depth.inv_depth[i] = SurfaceAmong(scene, i, begin, static_cast<size_t>(end - begin), votes);
      depth.beside[i] = !(depth.inv_depth[i] > 0) && scene.bounded && MissesObject(scene, i);
    }
    return depth;
  }

  std::vector<float> Shade(const WarpTask& task, const WarpDepth& depth, WarpedView* view) override {
    const WarpScene scene = SceneOf(task);
    std::vector<float> known(scene.pixels());
    for (size_t i = 0; i < scene.pixels(); ++i) {
      const ShadedPixel pixel = ShadePixel(scene, i, depth.inv_depth[i], depth.beside[i] != 0);
      float* rgb = &view->rgb.data[3 * i];
      rgb[0] = pixel.color.x, rgb[1] = pixel.color.y, rgb[2] = pixel.color.z;
      view->evidence[i] = pixel.evidence;
      view->provenance[i] = pixel.provenance;
      known[i] = pixel.known;
    }
    return known;
  }

 private:
  static WarpScene SceneOf(const WarpTask& task) {
    WarpScene scene = task.scene;
    scene.sources = task.sources.data();
    scene.count = static_cast<int>(task.sources.size());
    return scene;
  }
};

}  // namespace

std::unique_ptr<WarpDevice> MakeWarpDevice(Device device, const WarpSources& sources) {
  static_cast<void>(sources);  // the CPU reads the caller's images
  if (device.is_cpu()) return std::make_unique<CpuWarpDevice>();
  return CudaFunction<decltype(cuda::MakeCudaWarpDevice)>("MakeCudaWarpDevice")(sources, device.index,
                                                                                cuda::kListedSamples);
}

}  // namespace oraclegs
