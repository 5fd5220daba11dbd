#include "oraclegs/networks/seva/image_fit.h"

#include <algorithm>
#include <cmath>

namespace oraclegs::seva {
namespace {

void RequirePositive(const char* who, const Size& size) {
  if (size.width > 0 && size.height > 0) return;
  throw ShapeError("{}: an image of {} x {} pixels", who, size.width, size.height);
}

int64_t RoundTo(int64_t value, int64_t stride) {
  return static_cast<int64_t>(std::floor(static_cast<double>(value) / static_cast<double>(stride) + 0.5)) * stride;
}

/// Start of an axis of the resized image in the working image.
int64_t Offset(int64_t resized, int64_t working, FitMode mode) {
  if (mode == FitMode::kPad) return (working - resized) / 2;
  return -std::clamp<int64_t>(resized / 2 - working / 2, 0, resized - working);
}

/// Cuts the axis where `offset` is negative, pads it with zeros where it is positive.
Tensor Placed(const Tensor& x, int64_t dim, int64_t offset, int64_t size) {
  if (offset < 0 || x.size(dim) >= size) return x.slice(dim, -offset, -offset + size);
  std::vector<int64_t> before = x.sizes().vec(), after = before;
  before[static_cast<size_t>(dim)] = offset;
  after[static_cast<size_t>(dim)] = size - offset - x.size(dim);
  return at::cat({at::zeros(before, x.options()), x, at::zeros(after, x.options())}, dim);
}

/// Inverse of Placed; the border is repeated for what was cut.
Tensor Taken(const Tensor& x, int64_t dim, int64_t offset, int64_t size) {
  const Tensor places = at::arange(size, x.options().dtype(torch::kLong)) + offset;
  return x.index_select(dim, places.clamp(0, x.size(dim) - 1));
}

}  // namespace

Size WorkingSize(const Size& original, int64_t short_side, int64_t stride) {
  RequirePositive("WorkingSize", original);
  if (short_side <= 0 || stride <= 0) throw ShapeError("WorkingSize: side {} and stride {}", short_side, stride);
  const int64_t shorter = std::min(original.width, original.height);
  const int64_t longer = short_side * std::max(original.width, original.height) / shorter;
  const int64_t a = std::max(RoundTo(short_side, stride), stride), b = std::max(RoundTo(longer, stride), stride);
  return original.width > original.height ? Size{b, a} : Size{a, b};
}

ImageFit FitImage(const Size& original, const Size& working, FitMode mode) {
  RequirePositive("FitImage", original);
  RequirePositive("FitImage", working);
  const double by_height = static_cast<double>(working.height) / static_cast<double>(original.height);
  const double by_width = static_cast<double>(working.width) / static_cast<double>(original.width);
  const bool crop = mode == FitMode::kCrop;
  const double factor = crop ? std::max(by_height, by_width) : std::min(by_height, by_width);
  // A product may land just above a whole number: then the official code has one row more, and so have we.
  ImageFit fit{original,
               {static_cast<int64_t>(std::ceil(factor * static_cast<double>(original.width))),
                static_cast<int64_t>(std::ceil(factor * static_cast<double>(original.height)))},
               working};
  if (!crop) fit.resized = {std::min(fit.resized.width, working.width), std::min(fit.resized.height, working.height)};
  fit.left = Offset(fit.resized.width, working.width, mode);
  fit.top = Offset(fit.resized.height, working.height, mode);
  return fit;
}

Eigen::Matrix3d FittedIntrinsics(const Eigen::Matrix3d& pixels, const ImageFit& fit) {
  Eigen::Matrix3d k = pixels;
  k.row(0) *= static_cast<double>(fit.resized.width) / static_cast<double>(fit.original.width);
  k.row(1) *= static_cast<double>(fit.resized.height) / static_cast<double>(fit.original.height);
  k(0, 2) += static_cast<double>(fit.left);
  k(1, 2) += static_cast<double>(fit.top);
  k.row(0) /= static_cast<double>(fit.working.width);
  k.row(1) /= static_cast<double>(fit.working.height);
  return k;
}

Tensor ToWorkingSize(const Tensor& image, const ImageFit& fit) {
  const Tensor resized = at::adaptive_avg_pool2d(image, {fit.resized.height, fit.resized.width});
  return Placed(Placed(resized, 2, fit.top, fit.working.height), 3, fit.left, fit.working.width).contiguous();
}

Tensor FromWorkingSize(const Tensor& image, const ImageFit& fit) {
  const Tensor taken = Taken(Taken(image, 2, fit.top, fit.resized.height), 3, fit.left, fit.resized.width);
  return at::_upsample_bicubic2d_aa(taken.contiguous(), {fit.original.height, fit.original.width}, false);
}

}  // namespace oraclegs::seva
