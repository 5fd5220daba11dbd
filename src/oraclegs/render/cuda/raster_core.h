#pragma once
// The CUDA rasterizer on plain device memory: the order of the stages, and the memory between them.
//
// The host never waits for an idle device. How many pairs there are is known early in Forward and read only after all
// of it has been sent, for as many pairs as there was room; how many buckets, when the backward pass begins. Where
// there were more, memory grows and the stages after the count are sent once more; results do not depend on it.

#include "oraclegs/core/cuda/sort_scan.h"
#include "oraclegs/render/cuda/blend.h"
#include "oraclegs/render/cuda/splats.h"

namespace oraclegs::cuda {

/// Milliseconds of the last passes, as RenderTimings.
struct StageTimes {
  double project = 0, bin = 0, blend = 0, blend_backward = 0, gaussian_backward = 0;
};

/// Throws RunError when the tile lists of a view would hold 2^30 pairs and more.
void RequireCountable(int64_t gaussians, int64_t pairs);

class RasterCore {
 public:
  /// All work goes to `stream`, in order. `runs` of 32 entries make a bucket: 1, 2 or 4; 0: more, the more Gaussians
  /// there are.
  explicit RasterCore(cudaStream_t stream, int runs = 0) : stream_(stream), runs_(runs) {}

  /// Takes the memory for so many Gaussians now, without spare room; pairs come as they are needed. Throws OutOfMemory.
  void ReserveGaussians(int64_t n);

  /// Throws OutOfMemory, or RunError when there are 2^30 pairs and more.
  void Forward(const SplatCamera<float>& camera, const GaussianParameters& parameters, const ImagePlanes& out,
               bool train);

  /// The adjoint of the last Forward(train) up to the records of pairs; `parameters` as then, perhaps elsewhere in
  /// memory; the images that it wrote are read. What it returns is for RunGaussianBackward, and valid until the next
  /// Forward.
  GaussianBackwardInput BlendBackward(const GaussianParameters& parameters, const UpstreamPlanes& upstream);

  /// To be called when the Gaussian backward stage was sent: it is timed and counted until here.
  void EndBackward();

  cudaStream_t stream() const { return stream_; }
  /// These wait for the device.
  Counters counters() const;
  StageTimes times() const;

  /// Device memory held now.
  int64_t bytes() const;

  /// bytes() of training, about.
  static int64_t EstimateBytes(int64_t gaussians, int64_t pairs, int64_t pixels);

 private:
  /// In order of depth: the Gaussians, and the number of the first pair of each (`ids`, once they are sorted).
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

  // By Gaussian.
  DeviceArray<Splat> splats_{"the projected Gaussians"};
  DeviceArray<TileRect> rects_{"the tiles of Gaussians"};
  DeviceArray<uint32_t> counts_{"the tile counts of Gaussians"}, begins_{"the first pairs of Gaussians"};

  // By pair.
  int64_t pairs_ = 0, pair_room_ = 0;
  int64_t recent_pairs_ = 0;  ///< largest number of the recent views; it decays
  int64_t sent_pairs_ = 0;    ///< how many this view's binning was sent for, at most pair_room_
  DeviceArray<uint32_t> sorted_numbers_{"the tile lists"}, entry_ids_{"the tile lists"};
  /// First what is sorted, which is not needed once the ranges are known: tiles, sorted tiles, numbers, Gaussians,
  /// sent_pairs_ each. In the backward pass the records.
  DeviceArray<uint32_t> pair_work_{"the tile lists and the gradients of their entries"};

  // By tile and pixel, and by bucket.
  DeviceArray<TileRange> ranges_{"the tiles"};
  DeviceArray<uint32_t> ends_{"the pixels of the backward pass"};
  DeviceArray<Bucket> buckets_{"the buckets of the backward pass"};
  /// First the order of the Gaussians, of which nothing is needed once pairs are listed; the sort's input is scratch
  /// afterwards. From blending on the states of the buckets.
  DeviceArray<float> states_{"the order of Gaussians and the buckets of the backward pass"};

  Scratch scratch_{"sorting"};
  DeviceArray<Counters> counters_{"counters"};
  Readback<Counters> counted_, blended_, finished_;
  Event begin_, projected_, binned_, drawn_, backward_begin_, blended_backward_, end_;
};

}  // namespace oraclegs::cuda
