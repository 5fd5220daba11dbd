#include "oraclegs/evaluate/metrics.h"

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "oraclegs/loss/photometric.h"

namespace oraclegs {
namespace {

/// Checks that both are pictures of one size and the mask fits; returns the mask in double, all ones when undefined.
Tensor CheckedMask(const char* who, const Tensor& a, const Tensor& b, const Tensor& mask) {
  RequireFloat(who, "first image", a, {-1, -1, 3});
  RequireFloat(who, "second image", b, {a.size(0), a.size(1), 3});
  if (!mask.defined()) return torch::ones({a.size(0), a.size(1)}, torch::kDouble);
  if (mask.dim() != 2 || mask.size(0) != a.size(0) || mask.size(1) != a.size(1)) {
    throw ShapeError("{}: mask is [{}], expected [{}, {}]", who, fmt::join(mask.sizes(), ", "), a.size(0), a.size(1));
  }
  return mask.to(torch::kDouble);
}

/// Mean of values [H,W,3] over the pixels of the mask. NaN when it is empty.
double MaskedMean(const Tensor& values, const Tensor& mask) {
  const double pixels = mask.sum().item<double>();
  if (!(pixels > 0)) return std::numeric_limits<double>::quiet_NaN();
  return (values.to(torch::kDouble) * mask.unsqueeze(-1)).sum().item<double>() / (3 * pixels);
}

}  // namespace

Tensor Quantized(const Tensor& image) { return torch::floor(image.clamp(0, 1) * 255.f + 0.5f) / 255.f; }

double Psnr(const Tensor& a, const Tensor& b, const Tensor& mask) {
  const Tensor weights = CheckedMask("Psnr", a, b, mask);
  const Tensor difference = a.to(torch::kDouble) - b.to(torch::kDouble);
  return -10 * std::log10(MaskedMean(difference * difference, weights));
}

double Ssim(const Tensor& a, const Tensor& b, const Tensor& mask) {
  const Tensor weights = CheckedMask("Ssim", a, b, mask);
  if (!mask.defined()) return MaskedMean(SsimMap(a, b), weights);
  // The windows of pixels that count reach 5 pixels into those that do not: there both pictures are made the same, as
  // the training loss does it, so that what is masked says nothing.
  return MaskedMean(SsimMap(torch::where(weights.unsqueeze(-1) > 0, a, b).contiguous(), b), weights);
}

double ColorCorrectedPsnr(const Tensor& render, const Tensor& target, const Tensor& mask) {
  const Tensor weights = CheckedMask("ColorCorrectedPsnr", render, target, mask).reshape({-1});
  const int64_t n = weights.size(0);
  const Tensor from = torch::cat({render.reshape({n, 3}), torch::ones({n, 1})}, 1).to(torch::kDouble);
  const Tensor weighted = (from * weights.unsqueeze(-1)).t();
  const Tensor normal = weighted.mm(from).contiguous();
  const Tensor right = weighted.mm(target.reshape({n, 3}).to(torch::kDouble)).contiguous();
  using Square = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
  using Tall = Eigen::Matrix<double, 4, 3, Eigen::RowMajor>;
  // A flat or grey picture leaves colours undetermined: the decomposition then gives the smallest of the solutions.
  Tall map = Eigen::Map<const Square>(normal.data_ptr<double>())
                 .completeOrthogonalDecomposition()
                 .solve(Eigen::Map<const Tall>(right.data_ptr<double>()));
  const Tensor corrected = from.mm(torch::from_blob(map.data(), {4, 3}, torch::kDouble)).clamp(0, 1);
  return Psnr(corrected.to(torch::kFloat).reshape(render.sizes()).contiguous(), target, mask);
}

}  // namespace oraclegs
