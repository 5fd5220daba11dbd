#include "oraclegs/render/cuda/raster_core.h"

#include <algorithm>
#include <bit>
#include <cstddef>

#include "oraclegs/core/error.h"
#include "oraclegs/render/cuda/projection.h"
#include "oraclegs/render/cuda/tile_pairs.h"

namespace oraclegs::cuda {

namespace {

constexpr int64_t kSortedWords = 4;  // of a pair, see RasterCore::pair_work_
constexpr int64_t kPeakDecay = 64;   // views in which the remembered peak of pairs decays by 1/e
static_assert(kSortedWords <= kRecord && sizeof(float) == sizeof(uint32_t));

/// With room for a next view that has more.
int64_t WithSpare(int64_t count) { return count + count / 4; }

}  // namespace

void RequireCountable(int64_t gaussians, int64_t pairs) {
  if (pairs <= INT32_MAX / 2) return;  // a quarter more is room for the next view
  throw RunError("{} Gaussians cover {} tiles in one view, more than 2^30: lower --max-gaussians or raise --downscale",
                 gaussians, pairs);
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
  for (DeviceArray<uint32_t>* array : {&counts_, &begins_, &depths_, &sorted_depths_, &ids_, &sorted_ids_}) {
    array->Reserve(n);
  }
  counters_.ReserveExactly(1);
  ranges_.Reserve(camera.tiles());
  if (train) {
    sums_.Reserve(camera.tiles() * kTilePixels);
    transmittance_.Reserve(camera.tiles() * kTilePixels);
    ends_.Reserve(camera.tiles() * kTilePixels);
  }

  begin_.Record(stream_);
  counters_.FillBytes(0, 1, stream_);
  ProjectSplats(camera, parameters, splats_.data(), rects_.data(), stream_);
  projected_.Record(stream_);
  CountTiles(splats_.data(), rects_.data(), n, {counts_.data(), depths_.data(), ids_.data(), counters_.data()},
             stream_);
  counted_.Ask(counters_.data(), stream_);
  SortByKey({depths_.data(), ids_.data(), sorted_depths_.data(), sorted_ids_.data(), n}, 32, &scratch_, stream_);
  GatherCounts(counts_.data(), sorted_ids_.data(), n, depths_.data(), stream_);
  ExclusiveSum(depths_.data(), ids_.data(), n, &scratch_, stream_);

  // Usually this view has about as many pairs as the recent ones: all work is queued before their number is read.
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

void RasterCore::SendBinAndBlend() {
  pair_work_.ReserveExactly(pair_room_ * (train_ ? kRecord : kSortedWords));
  uint32_t* const tile_of = pair_work_.data();
  uint32_t* const sorted_tiles = tile_of + sent_pairs_;
  uint32_t* const numbers = sorted_tiles + sent_pairs_;
  uint32_t* const gaussians = numbers + sent_pairs_;
  pair_work_.FillBytes(0xff, sent_pairs_, stream_);  // tiles that no pair overwrites sort to the end
  ListPairs({splats_.data(), rects_.data(), sorted_ids_.data(), ids_.data(), parameters_.n, camera_.tiles_x},
            {tile_of, numbers, gaussians, begins_.data(), sent_pairs_}, stream_);
  const uint32_t tiles = static_cast<uint32_t>(camera_.tiles());
  SortByKey({tile_of, numbers, sorted_tiles, sorted_numbers_.data(), sent_pairs_}, std::bit_width(tiles), &scratch_,
            stream_);
  ranges_.FillBytes(0, camera_.tiles(), stream_);
  FindTileRanges({sorted_tiles, sorted_numbers_.data(), gaussians, sent_pairs_, tiles}, ranges_.data(),
                 entry_ids_.data(), stream_);
  binned_.Record(stream_);
  if (train_ && bucket_room_ == 0) {
    const int64_t guess = pair_room_ / kBucket / 2 + 2 * camera_.tiles();
    buckets_.ReserveExactly(guess);
    states_.ReserveExactly(guess * kStateFloats * kTilePixels);
    bucket_room_ = guess;
  }
  SendBlend(planes_);
  drawn_.Record(stream_);
}

void RasterCore::SendBlend(const ImagePlanes& out) {
  constexpr size_t kFirst = offsetof(Counters, pixel_pairs);
  Check(cudaMemsetAsync(reinterpret_cast<char*>(counters_.data()) + kFirst, 0, sizeof(Counters) - kFirst, stream_),
        "blending");
  BlendKept kept{};
  if (train_) {
    kept.ends = {sums_.data(), transmittance_.data(), ends_.data()};
    kept.buckets = {buckets_.data(), states_.data(), static_cast<uint32_t>(bucket_room_)};
  }
  BlendForward({camera_, splats_.data(), entry_ids_.data(), ranges_.data()}, out, kept, counters_.data(), stream_);
  blended_.Ask(counters_.data(), stream_);
}

GaussianBackwardInput RasterCore::BlendBackward(const GaussianParameters& parameters, const UpstreamPlanes& upstream) {
  if (!forward_done_ || !train_ || parameters.n != parameters_.n) {
    throw ShapeError("RasterCore::BlendBackward: {} Gaussians, but the last Forward was not to train as many",
                     parameters.n);
  }
  const int64_t buckets = blended_.Get().buckets;
  if (buckets > bucket_room_) {
    bucket_room_ = 0;
    const int64_t room = WithSpare(buckets);
    buckets_.ReserveExactly(room);
    states_.ReserveExactly(room * kStateFloats * kTilePixels);
    bucket_room_ = room;
    SendBlend({});  // the images stay as they are
  }
  backward_begin_.Record(stream_);
  pair_work_.FillBytes(0, pairs_ * kRecord, stream_);  // entries that contribute to no pixel write nothing
  const BlendInput forward{camera_, splats_.data(), entry_ids_.data(), ranges_.data()};
  const BlendKept kept{{sums_.data(), transmittance_.data(), ends_.data()},
                       {buckets_.data(), states_.data(), static_cast<uint32_t>(bucket_room_)}};
  cuda::BlendBackward({forward, kept, upstream, sorted_numbers_.data(), buckets}, records(), counters_.data(), stream_);
  blended_backward_.Record(stream_);
  return {camera_, parameters, begins_.data(), counts_.data(), records(), stream_};
}

void RasterCore::EndBackward() {
  finished_.Ask(counters_.data(), stream_);
  end_.Record(stream_);
  backward_done_ = true;
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

int64_t RasterCore::bytes() const {
  int64_t sum = splats_.bytes() + rects_.bytes() + ranges_.bytes() + sums_.bytes() + transmittance_.bytes() +
                ends_.bytes() + buckets_.bytes() + states_.bytes() + scratch_.bytes();
  for (const DeviceArray<uint32_t>* array : {&counts_, &begins_, &depths_, &sorted_depths_, &ids_, &sorted_ids_,
                                             &sorted_numbers_, &entry_ids_, &pair_work_}) {
    sum += array->bytes();
  }
  return sum;
}

}  // namespace oraclegs::cuda
