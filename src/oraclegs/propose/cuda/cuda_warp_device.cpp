#include "oraclegs/propose/warp_device.h"

#include <algorithm>
#include <limits>
#include <mutex>

#include "oraclegs/core/cuda/sort_scan.h"
#include "oraclegs/core/error.h"
#include "oraclegs/propose/cuda/warp_kernels.h"

namespace oraclegs::cuda {
namespace {

template <class T>
void Send(const T* from, size_t count, T* to) {
  if (count > 0) Check(cudaMemcpy(to, from, count * sizeof(T), cudaMemcpyHostToDevice), "sending images to the GPU");
}

/// The images of all views on the device, in order.
class SourceImages {
 public:
  explicit SourceImages(const WarpSources& sources) {
    for (const DepthMap& map : sources.maps) {
      begin_.push_back(pixels_);
      pixels_ += static_cast<int64_t>(map.size());
    }
    // A depth falls on a pixel at most once, so 32 bits can count the samples of a pixel.
    if (pixels_ > std::numeric_limits<uint32_t>::max()) {
      throw ShapeError("Warper: {} pixels in all views, at most 2^32 - 1 on a GPU", pixels_);
    }
    rgb_.ReserveExactly(3 * pixels_);
    inv_depth_.ReserveExactly(pixels_);
    confidence_.ReserveExactly(pixels_);
    const bool bounded = sources.silhouettes != nullptr && !sources.silhouettes->empty();
    const bool masked = std::any_of(sources.views.begin(), sources.views.end(),
                                    [](const LoadedView& view) { return !view.mask.empty(); });
    if (bounded) near_object_.ReserveExactly(pixels_);
    if (masked) mask_.ReserveExactly(pixels_);
    for (size_t v = 0; v < sources.maps.size(); ++v) {
      const DepthMap& map = sources.maps[v];
      const LoadedView& view = sources.views[v];
      const int64_t at = begin_[v];
      Send(view.rgb.data.data(), 3 * map.size(), rgb_.data() + 3 * at);
      Send(map.inv_depth.data(), map.size(), inv_depth_.data() + at);
      Send(map.confidence.data(), map.size(), confidence_.data() + at);
      if (!view.mask.empty()) Send(view.mask.data(), map.size(), mask_.data() + at);
      if (bounded) Send(sources.silhouettes->Mask(v).grown, map.size(), near_object_.data() + at);
    }
  }

  int64_t pixels() const { return pixels_; }

  /// The source with pointers to its images on the device.
  WarpSource Here(WarpSource source) const {
    const int64_t at = begin_[static_cast<size_t>(source.number)];
    source.rgb = rgb_.data() + 3 * at;
    source.inv_depth = inv_depth_.data() + at, source.confidence = confidence_.data() + at;
    if (source.mask != nullptr) source.mask = mask_.data() + at;
    if (source.near_object != nullptr) source.near_object = near_object_.data() + at;
    return source;
  }

 private:
  std::vector<int64_t> begin_;
  int64_t pixels_ = 0;
  DeviceArray<float> rgb_{"the images that are warped"}, inv_depth_{"the depth that images are warped by"},
      confidence_{"the confidence of the depth that images are warped by"};
  DeviceArray<uint8_t> mask_{"the masks of warped images"}, near_object_{"the silhouettes of warped images"};
};

/// Bands of pixels with at most `max_samples` samples each, or of one pixel.
std::vector<PixelBand> CutIntoBands(const std::vector<uint32_t>& counts, int64_t max_samples) {
  std::vector<PixelBand> bands;
  PixelBand band;
  for (const uint32_t count : counts) {
    if (band.end > band.begin && band.samples + count > max_samples) {
      bands.push_back(band);
      band = {band.end, band.end, band.first + static_cast<uint32_t>(band.samples), 0};
    }
    ++band.end;
    band.samples += count;
  }
  bands.push_back(band);
  return bands;
}

class CudaWarpDevice : public WarpDevice {
 public:
  CudaWarpDevice(const WarpSources& sources, int index, int64_t listed_samples)
      : index_(index), listed_samples_(listed_samples), images_(sources) {
    size_t pixels = 0;
    for (const DepthMap& map : sources.maps) pixels = std::max(pixels, map.size());
    Reserve(static_cast<int64_t>(pixels));
    sources_.ReserveExactly(static_cast<int64_t>(sources.maps.size()));
    samples_.ReserveExactly(std::min(listed_samples, kMaxSamplesOfDepth * images_.pixels()));
  }

  WarpDepth FindSurfaces(const WarpTask& task) override {
    const std::lock_guard lock(mutex_);
    const WarpScene scene = SceneOf(task);
    const auto pixels = static_cast<int64_t>(scene.pixels());
    Reserve(pixels);
    counts_.FillBytes(0, pixels, nullptr);
    for (int k = 0; k < scene.count; ++k) {
      RunCountSamples(scene, task.sources[static_cast<size_t>(k)], k, counts_.data(), nullptr);
    }
    ExclusiveSum(counts_.data(), ends_.data(), pixels, &scratch_, nullptr);
    std::vector<uint32_t> counts(scene.pixels());
    counts_.Download(pixels, counts.data());
    for (const PixelBand& band : CutIntoBands(counts, listed_samples_)) {
      samples_.ReserveExactly(band.samples);
      for (int k = 0; k < scene.count; ++k) {
        RunListSamples(scene, task.sources[static_cast<size_t>(k)], k, {band, ends_.data(), samples_.data()}, nullptr);
      }
      RunFindSurfaces({scene, band, counts_.data(), ends_.data(), samples_.data(), inv_depth_.data(), beside_.data()},
                      nullptr);
    }
    WarpDepth depth{std::vector<float>(scene.pixels()), std::vector<uint8_t>(scene.pixels())};
    inv_depth_.Download(pixels, depth.inv_depth.data());
    beside_.Download(pixels, depth.beside.data());
    return depth;
  }

  std::vector<float> Shade(const WarpTask& task, const WarpDepth& depth, WarpedView* view) override {
    const std::lock_guard lock(mutex_);
    const WarpScene scene = SceneOf(task);
    const auto pixels = static_cast<int64_t>(scene.pixels());
    Reserve(pixels);
    Send(depth.inv_depth.data(), scene.pixels(), inv_depth_.data());
    Send(depth.beside.data(), scene.pixels(), beside_.data());
    RunShade(
        {scene, inv_depth_.data(), beside_.data(), rgb_.data(), known_.data(), evidence_.data(), provenance_.data()},
        nullptr);
    std::vector<float> known(scene.pixels());
    rgb_.Download(3 * pixels, view->rgb.data.data());
    known_.Download(pixels, known.data());
    evidence_.Download(pixels, view->evidence.data());
    provenance_.Download(pixels, view->provenance.data());
    return known;
  }

 private:
  /// Copies the sources to the GPU and makes it this thread's.
  WarpScene SceneOf(const WarpTask& task) {
    UseDevice(index_);
    std::vector<WarpSource> here;
    for (const WarpSource& source : task.sources) here.push_back(images_.Here(source));
    TakeConfidence(task, &here);
    sources_.Upload(here.data(), static_cast<int64_t>(here.size()));
    WarpScene scene = task.scene;
    scene.sources = sources_.data();
    scene.count = static_cast<int>(here.size());
    return scene;
  }

  /// Sends the confidence that stands in for that of the sources' maps.
  void TakeConfidence(const WarpTask& task, std::vector<WarpSource>* here) {
    size_t total = 0;
    for (const std::vector<float>& of_source : task.confidence) total += of_source.size();
    if (total == 0) return;
    confidence_.ReserveExactly(static_cast<int64_t>(total));
    float* next = confidence_.data();
    for (size_t k = 0; k < task.confidence.size(); ++k) {
      Send(task.confidence[k].data(), task.confidence[k].size(), next);
      (*here)[k].confidence = next;
      next += task.confidence[k].size();
    }
  }

  void Reserve(int64_t pixels) {
    for (DeviceArray<uint32_t>* array : {&counts_, &ends_}) array->ReserveExactly(pixels);
    for (DeviceArray<float>* array : {&inv_depth_, &known_}) array->ReserveExactly(pixels);
    beside_.ReserveExactly(pixels);
    rgb_.ReserveExactly(3 * pixels);
    evidence_.ReserveExactly(pixels);
    provenance_.ReserveExactly(pixels);
  }

  static constexpr int64_t kMaxSamplesOfDepth = 81;  // samples: (2 kMaxSplat + 1)^2
  static constexpr const char* kDepths = "the depths that fall on a new view's pixels";
  static constexpr const char* kView = "a new view that images are warped into";

  const int index_;
  const int64_t listed_samples_;
  const SourceImages images_;
  std::mutex mutex_;  // all below belongs to the view in work
  DeviceArray<WarpSource> sources_{kView};
  DeviceArray<uint32_t> counts_{kDepths}, ends_{kDepths};
  DeviceArray<WarpSample> samples_{kDepths};
  Scratch scratch_{kDepths};
  DeviceArray<float> inv_depth_{kView}, rgb_{kView}, known_{kView}, confidence_{kView};
  DeviceArray<uint8_t> beside_{kView};
  DeviceArray<PixelEvidence> evidence_{kView};
  DeviceArray<uint16_t> provenance_{kView};
};

}  // namespace

std::unique_ptr<WarpDevice> MakeCudaWarpDevice(const WarpSources& sources, int index, int64_t listed_samples) {
  UseDevice(index);
  return std::make_unique<CudaWarpDevice>(sources, index, listed_samples);
}

}  // namespace oraclegs::cuda
