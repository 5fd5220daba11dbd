#include "oraclegs/networks/seva/image_fit.h"

namespace oraclegs::seva {
namespace {

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
