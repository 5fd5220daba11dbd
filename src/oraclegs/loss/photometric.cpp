#include "oraclegs/loss/photometric.h"

#include <algorithm>
#include <mutex>
#include <vector>

#include "oraclegs/core/parallel.h"
#include "oraclegs/loss/photometric_kernel.h"
#include "oraclegs/render/image_buffer.h"

namespace oraclegs {
namespace {

using photometric::Images;
using photometric::Scratch;
using photometric::Tile;
using photometric::TileSums;

constexpr int64_t kMaskGrain = 1 << 14;  // pixels a task
constexpr int kTileHeight = 48;          // rows; ten more are worked on for each tile's halo
constexpr int kWidthStep = 16;           // pixels; keeps the inner tiles' rows whole vectors

int CeilDiv(int a, int b) { return (a + b - 1) / b; }

/// Cuts the image into tiles. They depend on its size only, so the sums have the same bits for any number of threads.
void CutTiles(int width, int height, std::vector<Tile>* tiles) {
  tiles->clear();
  const int strips = CeilDiv(width, photometric::kMaxTileWidth);
  const int step = CeilDiv(CeilDiv(width, strips), kWidthStep) * kWidthStep;
  for (int y = 0; y < height; y += kTileHeight) {
    for (int x = 0; x < width; x += step) {
      tiles->push_back({x, y, std::min(x + step, width), std::min(y + kTileHeight, height)});
    }
  }
}

void RequireImage(const char* who, const char* name, const Buffer<float>& image) {
  RequireShape(who, name, image, {-1, -1, 3});
  if (!image.device().is_cpu()) throw ShapeError("{}: {} is not on the CPU", who, name);
  if (image.count() == 0) throw ShapeError("{}: {} is empty", who, name);
}

Images ImagesOf(const Buffer<float>& render, const Buffer<float>& target) {
  Images images;
  images.height = static_cast<int>(render.size(0));
  images.width = static_cast<int>(render.size(1));
  images.render = render.data();
  images.target = target.data();
  return images;
}

/// Writes where(mask > 0, inside, outside), pixel by pixel; an undefined `outside` is zero. Images are [H,W,3].
void SelectByMask(const Buffer<float>& mask, const Buffer<float>& inside, const Buffer<float>& outside,
                  const Buffer<float>& out) {
  const float* m = mask.data();
  const float* a = inside.data();
  const float* b = outside.defined() ? outside.data() : nullptr;
  float* o = out.data();
  ParallelBlocks(mask.count(), kMaskGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      for (int64_t c = 3 * i; c < 3 * i + 3; ++c) o[c] = m[i] > 0 ? a[c] : (b ? b[c] : 0.f);
    }
  });
}

}  // namespace

struct PhotometricLoss::Buffers {
  ImageBuffer masked;
  std::vector<Tile> tiles;
  std::vector<TileSums> sums;

  TileSums Run(const Images& images) {
    CutTiles(images.width, images.height, &tiles);
    sums.resize(tiles.size());
    // Scratch for all threads that can be busy at once: otherwise a late helper would allocate during a run.
    const size_t busy = std::min<size_t>(tiles.size(), static_cast<size_t>(NumThreads()));
    while (idle.size() < busy) idle.push_back(std::make_unique<Scratch>());
    ParallelFor(static_cast<int64_t>(tiles.size()), [&](int64_t i) {
      std::unique_ptr<Scratch> scratch = Take();
      sums[i] = photometric::RunTile(images, tiles[i], scratch.get());
      Return(std::move(scratch));
    });
    TileSums total;
    for (const TileSums& s : sums) {
      total.l1 += s.l1;
      total.dssim += s.dssim;
    }
    return total;
  }

 private:
  std::mutex mutex;
  std::vector<std::unique_ptr<Scratch>> idle;  // all of them between two calls

  std::unique_ptr<Scratch> Take() {
    const std::lock_guard<std::mutex> lock(mutex);
    std::unique_ptr<Scratch> scratch = std::move(idle.back());
    idle.pop_back();
    return scratch;
  }

  void Return(std::unique_ptr<Scratch> scratch) {
    const std::lock_guard<std::mutex> lock(mutex);
    idle.push_back(std::move(scratch));
  }
};

PhotometricLoss::PhotometricLoss() : buffers_(std::make_unique<Buffers>()) {}
PhotometricLoss::~PhotometricLoss() = default;
PhotometricLoss::PhotometricLoss(PhotometricLoss&&) noexcept = default;
PhotometricLoss& PhotometricLoss::operator=(PhotometricLoss&&) noexcept = default;

PhotometricValue PhotometricLoss::operator()(const Buffer<float>& render, const Buffer<float>& target,
                                             const PixelWeights& pixels, const PhotometricWeights& weights,
                                             Buffer<float>* grad) {
  constexpr const char* kWho = "PhotometricLoss";
  RequireImage(kWho, "render", render);
  const int64_t height = render.size(0), width = render.size(1);
  RequireShape(kWho, "target", target, {height, width, 3});
  const Buffer<float>& mask = pixels.values;
  if (mask.defined()) RequireShape(kWho, "the pixels' weights", mask, {height, width});
  const bool with_grad = grad != nullptr && grad->defined();
  if (with_grad) RequireShape(kWho, "grad", *grad, {height, width, 3});

  Buffer<float> seen = render;
  if (pixels.IsMask()) {
    // SSIM windows reach 5 pixels: where the mask is zero the render is replaced by the target, so that it neither
    // influences unmasked pixels nor takes a gradient from them.
    seen = buffers_->masked.Get({height, width, 3});
    SelectByMask(mask, render, target, seen);
  }
  const double entries = 3.0 * static_cast<double>(height) * static_cast<double>(width);
  Images images = ImagesOf(seen, target);
  if (mask.defined()) images.confidence = mask.data();
  if (with_grad) images.grad = grad->data();
  images.l1_scale = static_cast<float>(weights.l1 / entries);
  images.dssim_scale = static_cast<float>(weights.dssim / entries);

  const TileSums total = buffers_->Run(images);
  if (with_grad && pixels.IsMask()) SelectByMask(mask, *grad, {}, *grad);
  PhotometricValue value;
  value.l1 = total.l1 / entries;
  value.dssim = total.dssim / entries;
  value.loss = static_cast<double>(weights.l1) * value.l1 + static_cast<double>(weights.dssim) * value.dssim;
  return value;
}

Buffer<float> SsimMap(const Buffer<float>& a, const Buffer<float>& b) {
  RequireImage("SsimMap", "a", a);
  RequireShape("SsimMap", "b", b, {a.size(0), a.size(1), 3});
  Buffer<float> map = Buffer<float>::Empty(a.shape());
  Images images = ImagesOf(a, b);
  images.ssim = map.data();
  const int64_t tall = images.height;
  ParallelBlocks(tall, kTileHeight, [&](int64_t begin, int64_t end) {
    const auto scratch = std::make_unique<Scratch>();
    for (int x = 0; x < images.width; x += photometric::kMaxTileWidth) {
      const int right = std::min(x + photometric::kMaxTileWidth, images.width);
      photometric::RunTile(images, {x, static_cast<int>(begin), right, static_cast<int>(end)}, scratch.get());
    }
  });
  return map;
}

}  // namespace oraclegs
