#include "oraclegs/render/cuda/raster_core.h"

#include <algorithm>
#include <bit>
#include <cstddef>

#include "oraclegs/core/error.h"
#include "oraclegs/render/cuda/stages.h"
#include "oraclegs/render/render_inputs.h"

namespace oraclegs::cuda {

namespace {

constexpr int64_t kSortedWords = 4;  // of a pair, see RasterCore::pair_work_
constexpr int64_t kPeakDecay = 64;   // views in which the remembered peak of pairs decays by 1/e
static_assert(kSortedWords <= kRecord && sizeof(float) == sizeof(uint32_t));
constexpr int64_t kOrderWords = 4;  // of a Gaussian, see RasterCore::states_
constexpr int64_t kStateWords = int64_t{kStateFloats} * kTilePixels;
// Numbers of Gaussians from which a bucket has two runs, and four: a quarter of the states to write, keep and read.
// With fewer Gaussians there are too few buckets to fill a GPU.
constexpr int64_t kTwoRuns = 250'000, kFourRuns = 600'000;

/// `count` with spare room for a larger next view.
int64_t WithSpare(int64_t count) { return count + count / 8; }

/// Runs per bucket.
int RunsFor(int asked, int64_t gaussians) {
  if (asked > 0) return asked;
  return gaussians >= kFourRuns ? 4 : gaussians >= kTwoRuns ? 2 : 1;
}

}  // namespace

void RequireCountable(int64_t gaussians, int64_t pairs) {
  if (pairs <= INT32_MAX / 2) return;  // an eighth more is room for the next view
  throw RunError("{} Gaussians cover {} tiles in one view, more than 2^30: lower --max-gaussians or raise --downscale",
                 gaussians, pairs);
}

void RasterCore::ReserveGaussians(int64_t n) {
  splats_.ReserveExactly(n);
  rects_.ReserveExactly(n);
  counts_.ReserveExactly(n);
  begins_.ReserveExactly(n);
  states_.ReserveExactly(kOrderWords * n);
}

void RasterCore::ReservePairs(int64_t pairs) {
  RequireCountable(parameters_.n, pairs);
  pair_room_ = 0;  // until all is there
  const int64_t room = WithSpare(pairs);
  sorted_numbers_.ReserveExactly(room);
  entry_ids_.ReserveExactly(room);
  pair_room_ = room;
}

void RasterCore::Forward(const SplatCamera<float>& camera, const GaussianParameters& parameters, const ImagePlanes& out,
                         bool train) {
  forward_done_ = backward_done_ = false;
  camera_ = camera;
  parameters_ = parameters;
  planes_ = out;
  train_ = train;
  const int64_t n = parameters.n;
  splats_.Reserve(n);
  rects_.Reserve(n);
  counts_.Reserve(n);
  begins_.Reserve(n);
  states_.Reserve(kOrderWords * n);
  counters_.ReserveExactly(1);
  ranges_.ReserveExactly(camera.tiles());
  if (train) {
    ends_.ReserveExactly(camera.tiles() * kTilePixels);
    ReserveBuckets(0);
  }

  begin_.Record(stream_);
  counters_.FillBytes(0, 1, stream_);
  ProjectSplats(camera, parameters, splats_.data(), rects_.data(), stream_);
  projected_.Record(stream_);
  const Order order = OrderOf(n);
  CountTiles(splats_.data(), rects_.data(), n, {counts_.data(), order.depths, order.ids, counters_.data()}, stream_);
  counted_.Ask(counters_.data(), stream_);
  SortByKey({order.depths, order.ids, order.sorted_depths, order.sorted_ids, n}, 32, &scratch_, stream_);
  GatherCounts(counts_.data(), order.sorted_ids, n, order.depths, stream_);
  ExclusiveSum(order.depths, order.ids, n, &scratch_, stream_);

  // This view usually has about as many pairs as the recent ones: all work is queued before the number is read.
  sent_pairs_ = std::min(pair_room_, WithSpare(recent_pairs_));
  const bool sent = sent_pairs_ > 0;
  if (sent) SendBinAndBlend();
  pairs_ = static_cast<int64_t>(counted_.Get().pairs);
  recent_pairs_ = std::max(pairs_, recent_pairs_ - recent_pairs_ / kPeakDecay);
  if (pairs_ > pair_room_) ReservePairs(pairs_);
  if (!sent || pairs_ > sent_pairs_) {
    sent_pairs_ = std::min(pair_room_, WithSpare(recent_pairs_));
    SendBinAndBlend();
  }
  forward_done_ = true;
}

RasterCore::Order RasterCore::OrderOf(int64_t n) {
  uint32_t* const words = reinterpret_cast<uint32_t*>(states_.data());
  return {words, words + n, words + 2 * n, words + 3 * n};
}

int64_t RasterCore::BucketRoom() const { return std::min(states_.capacity() / kStateWords, buckets_.capacity()); }

void RasterCore::ReserveBuckets(int64_t buckets) {
  states_.ReserveExactly(buckets * kStateWords);
  buckets_.ReserveExactly(states_.capacity() / kStateWords);
}

void RasterCore::SendBinAndBlend() {
  pair_work_.ReserveExactly(pair_room_ * (train_ ? kRecord : kSortedWords));
  uint32_t* const tile_of = pair_work_.data();
  uint32_t* const sorted_tiles = tile_of + sent_pairs_;
  uint32_t* const numbers = sorted_tiles + sent_pairs_;
  uint32_t* const gaussians = numbers + sent_pairs_;
  pair_work_.FillBytes(0xff, sent_pairs_, stream_);  // tiles that no pair overwrites sort to the end
  const Order order = OrderOf(parameters_.n);
  ListPairs({splats_.data(), rects_.data(), order.sorted_ids, order.ids, parameters_.n, camera_.tiles_x},
            {tile_of, numbers, gaussians, begins_.data(), sent_pairs_}, stream_);
  const uint32_t tiles = static_cast<uint32_t>(camera_.tiles());
  SortByKey({tile_of, numbers, sorted_tiles, sorted_numbers_.data(), sent_pairs_}, std::bit_width(tiles), &scratch_,
            stream_);
  ranges_.FillBytes(0, camera_.tiles(), stream_);
  FindTileRanges({sorted_tiles, sorted_numbers_.data(), gaussians, sent_pairs_, tiles}, ranges_.data(),
                 entry_ids_.data(), stream_);
  binned_.Record(stream_);
  SendBlend(planes_);
  drawn_.Record(stream_);
}

void RasterCore::SendBlend(const ImagePlanes& out) {
  constexpr size_t kFirst = offsetof(Counters, pixel_pairs);
  Check(cudaMemsetAsync(reinterpret_cast<char*>(counters_.data()) + kFirst, 0, sizeof(Counters) - kFirst, stream_),
        "blending");
  BlendForward(Listed(), out, train_ ? Kept() : BlendKept{}, counters_.data(), stream_);
  blended_.Ask(counters_.data(), stream_);
}

BlendInput RasterCore::Listed() { return {camera_, splats_.data(), entry_ids_.data(), ranges_.data(), sent_pairs_}; }

BlendKept RasterCore::Kept() {
  return {ends_.data(),
          {buckets_.data(), states_.data(), static_cast<uint32_t>(BucketRoom()),
           static_cast<uint32_t>(RunsFor(runs_, parameters_.n))}};
}

GaussianBackwardInput RasterCore::BlendBackward(const GaussianParameters& parameters, const UpstreamPlanes& upstream) {
  if (!forward_done_ || !train_ || parameters.n != parameters_.n) {
    throw ShapeError("RasterCore::BlendBackward: {} Gaussians, but the last Forward was not to train as many",
                     parameters.n);
  }
  const int64_t buckets = blended_.Get().buckets;
  if (buckets > BucketRoom()) {
    ReserveBuckets(WithSpare(buckets));
    SendBlend({});  // the images stay as they are
  }
  camera_summed_ = false;  // until the pass ends
  if (watches_camera_) {
    warp_camera_sums_.Reserve(kCameraSums * WarpsOf(parameters.n));
    camera_sums_.ReserveExactly(1);
  }
  backward_begin_.Record(stream_);
  pair_work_.FillBytes(0, pairs_ * kRecord, stream_);  // entries that contribute to no pixel write nothing
  cuda::BlendBackward({Listed(), planes_, Kept(), upstream, sorted_numbers_.data(), buckets}, records(),
                      counters_.data(), stream_);
  blended_backward_.Record(stream_);
  GaussianBackwardInput out{camera_, parameters, begins_.data(), counts_.data(), records(), stream_};
  if (watches_camera_) out.camera_sums = warp_camera_sums_.data();
  return out;
}

void RasterCore::EndBackward() {
  if (watches_camera_) {
    AddCameraSums(warp_camera_sums_.data(), WarpsOf(parameters_.n), camera_sums_.data(), stream_);
    camera_read_.Ask(camera_sums_.data(), stream_);
    watched_camera_ = camera_;
    camera_summed_ = true;
  }
  finished_.Ask(counters_.data(), stream_);
  end_.Record(stream_);
  backward_done_ = true;
}

CameraGradient RasterCore::camera_gradient() const {
  RequireCameraGradient(camera_summed_);
  return CameraGradientOf(watched_camera_, camera_read_.Get().of);
}

Counters RasterCore::counters() const {
  if (!forward_done_) return {};
  return backward_done_ ? finished_.Get() : blended_.Get();
}

StageTimes RasterCore::times() const {
  StageTimes times;
  if (!forward_done_) return times;
  drawn_.Wait();
  times.project = projected_.MillisecondsSince(begin_);
  times.bin = binned_.MillisecondsSince(projected_);
  times.blend = drawn_.MillisecondsSince(binned_);
  if (!backward_done_) return times;
  end_.Wait();
  times.blend_backward = blended_backward_.MillisecondsSince(backward_begin_);
  times.gaussian_backward = end_.MillisecondsSince(blended_backward_);
  return times;
}

int64_t RasterCore::EstimateBytes(int64_t gaussians, int64_t pairs, int64_t pixels) {
  constexpr int64_t kOfGaussian = sizeof(Splat) + sizeof(TileRect) + 2 * sizeof(uint32_t);
  constexpr int64_t kOfPair = sizeof(float) * (kRecord + 2) + 8;  // the last is what sorting them takes
  constexpr int64_t kOfBucket = sizeof(float) * kStateWords + sizeof(Bucket);
  // Every tile ends with a partly filled bucket.
  const int64_t buckets = pairs / (RunsFor(0, gaussians) * kRun) + pixels / kTilePixels;
  return kOfGaussian * gaussians + WithSpare(kOfPair * pairs) + WithSpare(kOfBucket * buckets) +
         static_cast<int64_t>(sizeof(uint32_t)) * pixels;
}

int64_t RasterCore::bytes() const {
  int64_t sum = splats_.bytes() + rects_.bytes() + ranges_.bytes() + buckets_.bytes() + states_.bytes() +
                scratch_.bytes() + warp_camera_sums_.bytes();
  for (const DeviceArray<uint32_t>* array : {&counts_, &begins_, &ends_, &sorted_numbers_, &entry_ids_, &pair_work_}) {
    sum += array->bytes();
  }
  return sum;
}

}  // namespace oraclegs::cuda
