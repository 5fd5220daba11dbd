#pragma once
// The CUDA rasterizer on plain device memory: the order of the stages, and the memory between them.
//
// The host never waits for an idle device. The number of pairs is known early in Forward and read only after all stages
// are queued for the available room; the number of buckets is read when the backward pass begins. If there were more,
// memory grows and the stages after the count are queued again; results do not depend on it.

#include "oraclegs/core/cuda/sort_scan.h"
#include "oraclegs/render/cuda/splats.h"
#include "oraclegs/render/cuda/stages.h"

namespace oraclegs::cuda {

/// Milliseconds of the last passes, as RenderTimings.
struct StageTimes {
  double project = 0, bin = 0, blend = 0, blend_backward = 0, gaussian_backward = 0;
};

/// Throws RunError when the tile lists of a view would hold 2^30 pairs and more.
void RequireCountable(int64_t gaussians, int64_t pairs);

class RasterCore {
 public:
  /// Sends all work to `stream`, in order. `runs`: runs of 32 entries per bucket: 1, 2 or 4; 0: chosen by the number of
  /// Gaussians.
  explicit RasterCore(cudaStream_t stream, int runs = 0) : stream_(stream), runs_(runs) {}

  /// Allocates for that many Gaussians now, without spare room; memory of pairs grows on demand. Throws OutOfMemory.
  void ReserveGaussians(int64_t n);

  /// Renders into `out`. Throws OutOfMemory, or RunError for 2^30 pairs or more.
  void Forward(const SplatCamera<float>& camera, const GaussianParameters& parameters, const ImagePlanes& out,
               bool train);

  /// The adjoint of the last Forward(train) up to the records of pairs. `parameters` have the same values, perhaps at
  /// another address; reads the images that Forward wrote. The result is for RunGaussianBackward, and valid until the
  /// next Forward.
  GaussianBackwardInput BlendBackward(const GaussianParameters& parameters, const UpstreamPlanes& upstream);

  /// Ends the times, counts and sums of the backward pass. Call it when the Gaussian backward stage is queued.
  void EndBackward();

  /// As Rasterizer's.
  void WatchCamera(bool watched) { watches_camera_ = watched; }
  CameraGradient camera_gradient() const;

  cudaStream_t stream() const { return stream_; }
  /// Counts of the last passes; like times(), waits for the device.
  Counters counters() const;
  StageTimes times() const;

  /// Device memory held now.
  int64_t bytes() const;

  /// Estimate of bytes() in training.
  static int64_t EstimateBytes(int64_t gaussians, int64_t pairs, int64_t pixels);

 private:
  /// Order by depth: the Gaussians, and the number of the first pair of each (`ids`, once they are sorted).
  struct Order {
    uint32_t *depths, *ids, *sorted_depths, *sorted_ids;
  };
  Order OrderOf(int64_t n);
  int64_t BucketRoom() const;
  void ReserveBuckets(int64_t buckets);
  BlendInput Listed();
  BlendKept Kept();
  void SendBinAndBlend();
  void SendBlend(const ImagePlanes& out);
  float* records() { return reinterpret_cast<float*>(pair_work_.data()); }
  void ReservePairs(int64_t pairs);

  cudaStream_t stream_;
  int runs_;
  SplatCamera<float> camera_{};
  GaussianParameters parameters_{};
  ImagePlanes planes_{};
  bool train_ = false, forward_done_ = false, backward_done_ = false;

  // Per Gaussian.
  DeviceArray<Splat> splats_{"the projected Gaussians"};
  DeviceArray<TileRect> rects_{"the tiles of Gaussians"};
  DeviceArray<uint32_t> counts_{"the tile counts of Gaussians"}, begins_{"the first pairs of Gaussians"};

  // Per pair.
  int64_t pairs_ = 0, pair_room_ = 0;
  int64_t recent_pairs_ = 0;  ///< decaying maximum over the recent views
  int64_t sent_pairs_ = 0;    ///< pairs that this view's binning was queued for, at most pair_room_
  DeviceArray<uint32_t> sorted_numbers_{"the tile lists"}, entry_ids_{"the tile lists"};
  /// Input of the sort, which is not needed once the ranges are known: tiles, sorted tiles, numbers, Gaussians,
  /// sent_pairs_ each. In the backward pass: the records.
  DeviceArray<uint32_t> pair_work_{"the tile lists and the gradients of their entries"};

  // Per tile and pixel, and per bucket.
  DeviceArray<TileRange> ranges_{"the tiles"};
  DeviceArray<uint32_t> ends_{"the pixels of the backward pass"};
  DeviceArray<Bucket> buckets_{"the buckets of the backward pass"};
  /// The order of the Gaussians, until pairs are listed; the sort's input is scratch afterwards. From blending on: the
  /// states of the buckets.
  DeviceArray<float> states_{"the order of Gaussians and the buckets of the backward pass"};

  Scratch scratch_{"sorting"};
  DeviceArray<Counters> counters_{"counters"};
  Readback<Counters> counted_, blended_, finished_;

  // The gradient of the camera.
  bool watches_camera_ = false, camera_summed_ = false;
  SplatCamera<float> watched_camera_{};  ///< of the last backward pass
  DeviceArray<float> warp_camera_sums_{"the gradient of the camera"};
  DeviceArray<CameraSums> camera_sums_{"the gradient of the camera"};
  Readback<CameraSums> camera_read_;

  Event begin_, projected_, binned_, drawn_, backward_begin_, blended_backward_, end_;
};

}  // namespace oraclegs::cuda
