#include "oraclegs/render/render.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <optional>

#include "oraclegs/core/parallel.h"
#include "oraclegs/render/cpu/kernels.h"
#include "oraclegs/render/cpu/scratch_array.h"
#include "oraclegs/render/cpu/tile_lists.h"
#include "oraclegs/render/image_buffer.h"
#include "oraclegs/render/render_inputs.h"
#include "oraclegs/render/splat_camera.h"

namespace oraclegs::cpu {
namespace {

constexpr int64_t kProjectGrain = 1024;  // Gaussians a task

/// Milliseconds since the last call.
class StageClock {
 public:
  double Lap() {
    const auto now = std::chrono::steady_clock::now();
    const double ms = std::chrono::duration<double, std::milli>(now - last_).count();
    last_ = now;
    return ms;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// The gradients of one block, on the stack of its thread.
struct BlockGrads {
  alignas(64) float means[3 * kGradBlock];
  alignas(64) float log_scales[3 * kGradBlock];
  alignas(64) float quats[4 * kGradBlock];
  alignas(64) float opacity_logits[kGradBlock];
  alignas(64) float sh[kShFloats * kGradBlock];

  GaussianRows Rows() { return {means, log_scales, quats, opacity_logits, sh}; }
};

class CpuRasterizer final : public Rasterizer {
 public:
  RenderOutput Forward(const Gaussians& gaussians, const Camera& camera, const RenderOptions& options,
                       RenderPass pass) override {
    const GaussianParameters parameters = ForwardParameters(gaussians, camera, options, kCpu);
    const int64_t n = parameters.n;
    trained_size_ = -1;  // until all is in place
    StageClock clock;
    input_ = {MakeSplatCamera<float>(camera, options), parameters};
    splats_.Reserve(n);
    rects_.Reserve(n);
    ParallelBlocks(n, kProjectGrain, [&](int64_t begin, int64_t end) {
      ProjectSplats(input_, begin, end, splats_.data(), rects_.data());
    });
    timings_.project = clock.Lap();

    lists_.Build(splats_.data(), rects_.data(), n, input_.camera.tiles_x, input_.camera.tiles_y);
    stats_ = {lists_.visible, lists_.pairs};
    timings_.bin = clock.Lap();

    output_ = {image_.Get({camera.height, camera.width, 3}), alpha_.Get({camera.height, camera.width}),
               inv_depth_.Get({camera.height, camera.width})};
    const int64_t tiles = input_.camera.tiles();
    const bool train = pass == RenderPass::kTrain;
    if (train) {
      transmittance_.Reserve(tiles * kTilePixels);
      end_.Reserve(tiles * kTilePixels);
    }
    blend_ = {camera.width,
              camera.height,
              {options.background[0], options.background[1], options.background[2]},
              output_.image.data(),
              output_.alpha.data(),
              output_.inv_depth.data(),
              train ? transmittance_.data() : nullptr,
              train ? end_.data() : nullptr};
    stats_.pixel_pairs = SumOverTiles([&](int64_t tile) { return BlendTile(Work(tile), blend_); });
    timings_.blend = clock.Lap();
    trained_size_ = train ? n : -1;
    return output_;
  }

  void Backward(const Gaussians& gaussians, const RenderGrads& upstream, Gaussians* grads) override {
    const GaussianRows rows = GradientRows(*grads, gaussians.size(), kCpu);
    BackwardOfBlocks(gaussians, upstream, [&](const GradInput& in, int64_t begin, int64_t end) {
      ProjectSplatsBackward(input_, in, begin, end, rows.From(begin));
    });
  }

  void BackwardInto(const Gaussians& gaussians, const RenderGrads& upstream, GradientConsumer* consumer) override {
    BackwardOfBlocks(gaussians, upstream, [&](const GradInput& in, int64_t begin, int64_t end) {
      BlockGrads grads;
      ProjectSplatsBackward(input_, in, begin, end, grads.Rows());
      consumer->ConsumeBlock(begin, end, grads.Rows());
    });
  }

  void WatchScreen(const ScreenGradients* watched) override {
    watched_ = watched == nullptr ? ScreenGradients() : *watched;
  }

  void WatchCamera(bool watched) override { watches_camera_ = watched; }

  CameraGradient camera_gradient() const override {
    RequireCameraGradient(camera_gradient_.has_value());
    return *camera_gradient_;
  }

  RenderTimings timings() const override { return timings_; }
  RenderStats stats() const override { return stats_; }

 private:
  TileWork Work(int64_t tile) const {
    const int64_t* begin = lists_.tile_begin.data() + tile;
    const bool last = tile + 1 == input_.camera.tiles();
    return {splats_.data(),
            lists_.entries.data() + begin[0],
            begin[1] - begin[0],
            last ? 0 : begin[2] - begin[1],
            static_cast<int>(tile % input_.camera.tiles_x),
            static_cast<int>(tile / input_.camera.tiles_x),
            tile};
  }

  /// Sum of body(tile) over all tiles, run on all threads. Neighbors share cache lines of the image, so a task is a
  /// range of them.
  template <class Body>
  int64_t SumOverTiles(const Body& body) {
    const int64_t tiles = input_.camera.tiles();
    std::atomic<int64_t> sum{0};  // of integers: the same in any order
    ParallelBlocks(tiles, std::max<int64_t>(1, tiles / (16 * NumThreads())), [&](int64_t begin, int64_t end) {
      int64_t part = 0;
      for (int64_t tile = begin; tile < end; ++tile) part += body(tile);
      sum += part;
    });
    return sum;
  }

  /// The backward pass; body(in, begin, end) is the per-Gaussian stage of one block.
  template <class Body>
  void BackwardOfBlocks(const Gaussians& gaussians, const RenderGrads& upstream, const Body& body) {
    camera_gradient_.reset();  // until all is in place
    const GradInput in = BlendBackward(gaussians, upstream);
    StageClock clock;
    const int64_t n = gaussians.size(), blocks = (n + kGradBlock - 1) / kGradBlock;
    if (watches_camera_) block_camera_sums_.Reserve(blocks * kCameraSums);
    ParallelBlocks(n, kGradBlock, [&](int64_t begin, int64_t end) {
      GradInput of_block = in;
      if (watches_camera_) of_block.camera_sums = block_camera_sums_.data() + begin / kGradBlock * kCameraSums;
      body(of_block, begin, end);
    });
    if (watches_camera_) {
      double sums[kCameraSums] = {};
      for (int64_t i = 0; i < blocks * kCameraSums; ++i) sums[i % kCameraSums] += block_camera_sums_.data()[i];
      camera_gradient_ = CameraGradientOf(input_.camera, sums);
    }
    timings_.gaussian_backward = clock.Lap();
  }

  /// Fills the records. Returns the input of the per-Gaussian stage.
  GradInput BlendBackward(const Gaussians& gaussians, const RenderGrads& upstream) {
    // The parameters may have moved to other memory since Forward, but not changed.
    input_.gaussians = BackwardParameters(gaussians, trained_size_);
    const UpstreamPlanes up = PlanesOf(upstream, blend_.height, blend_.width, kCpu);
    StageClock clock;
    records_.Reserve(lists_.pair_numbers * kGradStride);
    stats_.pixel_pairs_backward =
        SumOverTiles([&](int64_t tile) { return BlendTileBackward(Work(tile), blend_, up, records_.data()); });
    timings_.blend_backward = clock.Lap();
    RequireWatched(watched_, gaussians.size(), kCpu);
    return {lists_.ranges.data(), lists_.pair_tile.data(), records_.data(),
            splats_.data(),       watched_.sum.data(),     watched_.views.data()};
  }

  ProjectInput input_{};
  BlendImage blend_{};
  RenderOutput output_;
  TileLists lists_;
  ImageBuffer image_, alpha_, inv_depth_;
  ScratchArray<LineSplat> splats_;
  ScratchArray<TileRect> rects_;
  ScratchArray<float> transmittance_;
  ScratchArray<uint32_t> end_;
  ScratchArray<float> records_;  // one cache line a pair
  int64_t trained_size_ = -1;
  ScreenGradients watched_;  // undefined = none
  bool watches_camera_ = false;
  ScratchArray<float> block_camera_sums_;  // [blocks, kCameraSums]
  std::optional<CameraGradient> camera_gradient_;
  RenderTimings timings_;
  RenderStats stats_;
};

}  // namespace

std::unique_ptr<Rasterizer> MakeCpuRasterizer() { return std::make_unique<CpuRasterizer>(); }

}  // namespace oraclegs::cpu
