#include "oraclegs/evaluate/metrics.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "oraclegs/core/parallel.h"
#include "oraclegs/loss/photometric.h"

namespace oraclegs {
namespace {

constexpr int64_t kPixelGrain = 1 << 14;  // pixels a block

using Equations = Eigen::Matrix<double, 4, 7>;

Eigen::Vector4d Homogeneous(const float* color) { return {color[0], color[1], color[2], 1}; }

/// Throws ShapeError unless both are images of one size and the mask, if there is one, fits.
void CheckImages(const char* who, const Buffer<float>& a, const Buffer<float>& b, const Buffer<float>& mask) {
  RequireShape(who, "first image", a, {-1, -1, 3});
  RequireShape(who, "second image", b, {a.size(0), a.size(1), 3});
  if (mask.defined()) RequireShape(who, "mask", mask, {a.size(0), a.size(1)});
}

/// Weight of a pixel; 1 for an undefined mask.
double Weight(const Buffer<float>& mask, int64_t pixel) {
  return mask.defined() ? static_cast<double>(mask[pixel]) : 1.0;
}

/// Sums over pixels in blocks of fixed size, so that the sum has the same bits for any number of threads. add(pixel,
/// &sum) adds one pixel.
template <class Sum, class Add>
Sum SumOverPixels(int64_t pixels, const Sum& zero, const Add& add) {
  std::vector<Sum> sums(static_cast<size_t>((pixels + kPixelGrain - 1) / kPixelGrain), zero);
  ParallelBlocks(pixels, kPixelGrain, [&](int64_t begin, int64_t end) {
    Sum sum = zero;
    for (int64_t i = begin; i < end; ++i) add(i, &sum);
    sums[static_cast<size_t>(begin / kPixelGrain)] = sum;
  });
  Sum total = zero;
  for (const Sum& sum : sums) total += sum;
  return total;
}

/// Mean of value(i), i an index into [H,W,3], over the pixels of the mask. NaN when it is empty.
template <class Value>
double MaskedMean(int64_t pixels, const Buffer<float>& mask, const Value& value) {
  const Eigen::Array2d sums =
      SumOverPixels<Eigen::Array2d>(pixels, Eigen::Array2d::Zero(), [&](int64_t i, Eigen::Array2d* sum) {
        *sum += Weight(mask, i) * Eigen::Array2d(1, value(3 * i) + value(3 * i + 1) + value(3 * i + 2));
      });
  if (!(sums[0] > 0)) return std::numeric_limits<double>::quiet_NaN();
  return sums[1] / (3 * sums[0]);
}

int64_t Pixels(const Buffer<float>& image) { return image.size(0) * image.size(1); }

}  // namespace

Buffer<float> Quantized(const Buffer<float>& image) {
  Buffer<float> rounded = Buffer<float>::Empty(image.shape());
  for (int64_t i = 0; i < image.count(); ++i) {
    rounded[i] = std::floor(std::clamp(image[i], 0.f, 1.f) * 255.f + 0.5f) / 255.f;
  }
  return rounded;
}

Buffer<float> WithMaskedFrom(const Buffer<float>& image, const Buffer<float>& other, const Buffer<float>& mask) {
  if (!mask.defined()) return image;
  Buffer<float> merged = other.Clone();
  for (int64_t i = 0; i < mask.count(); ++i) {
    if (mask[i] > 0) std::copy_n(image.data() + 3 * i, 3, merged.data() + 3 * i);
  }
  return merged;
}

double Psnr(const Buffer<float>& a, const Buffer<float>& b, const Buffer<float>& mask) {
  CheckImages("Psnr", a, b, mask);
  const float *left = a.data(), *right = b.data();
  const double mse = MaskedMean(Pixels(a), mask, [&](int64_t i) {
    const double difference = static_cast<double>(left[i]) - static_cast<double>(right[i]);
    return difference * difference;
  });
  return -10 * std::log10(mse);
}

double Ssim(const Buffer<float>& a, const Buffer<float>& b, const Buffer<float>& mask) {
  CheckImages("Ssim", a, b, mask);
  // Windows of unmasked pixels reach 5 pixels into masked ones: there the images are made equal, as in the training
  // loss, so that masked pixels are ignored.
  const Buffer<float> map = SsimMap(WithMaskedFrom(a, b, mask), b);
  const float* values = map.data();
  return MaskedMean(Pixels(a), mask, [&](int64_t i) { return static_cast<double>(values[i]); });
}

Buffer<float> ColorCorrected(const Buffer<float>& render, const Buffer<float>& target, const Buffer<float>& mask) {
  CheckImages("ColorCorrected", render, target, mask);
  const int64_t pixels = Pixels(render);
  const float *from = render.data(), *to = target.data();
  // Normal equations of w (from, 1) M = w to: the left four columns, and the right side in the other three.
  const Equations equations = SumOverPixels<Equations>(pixels, Equations::Zero(), [&](int64_t i, Equations* sum) {
    const Eigen::Vector4d row = Homogeneous(from + 3 * i);
    const double w = Weight(mask, i);
    sum->leftCols<4>() += w * row * row.transpose();
    sum->rightCols<3>() += w * row * Eigen::Map<const Eigen::RowVector3f>(to + 3 * i).cast<double>();
  });
  // A flat or gray image leaves colors undetermined: the decomposition then gives the solution of least norm.
  const Eigen::Matrix<double, 4, 3> map =
      Eigen::Matrix4d(equations.leftCols<4>()).completeOrthogonalDecomposition().solve(equations.rightCols<3>());
  Buffer<float> corrected = Buffer<float>::Empty(render.shape());
  float* out = corrected.data();
  ParallelBlocks(pixels, kPixelGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      const Eigen::Vector3d color = map.transpose() * Homogeneous(from + 3 * i);
      Eigen::Map<Eigen::Vector3f>(out + 3 * i) = color.cwiseMax(0).cwiseMin(1).cast<float>();
    }
  });
  return corrected;
}

double ColorCorrectedPsnr(const Buffer<float>& render, const Buffer<float>& target, const Buffer<float>& mask) {
  return Psnr(ColorCorrected(render, target, mask), target, mask);
}

}  // namespace oraclegs
