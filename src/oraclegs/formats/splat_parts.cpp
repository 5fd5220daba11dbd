#include "oraclegs/formats/splat_parts.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "oraclegs/core/parallel.h"
#include "oraclegs/formats/values.h"

namespace oraclegs {
namespace {

constexpr double kUneven = 1e-3;  // relative

}  // namespace

std::optional<Similarity> EvenSimilarity(const Eigen::Matrix4d& matrix) {
  const Eigen::Matrix3d linear = matrix.topLeftCorner<3, 3>();
  const double scale = std::cbrt(linear.determinant());
  const Eigen::Matrix3d rotation = linear / scale;
  const bool even = scale > 0 && matrix.allFinite() &&
                    (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < kUneven;
  if (!even) return std::nullopt;
  return Similarity{rotation, scale, matrix.topRightCorner<3, 1>()};
}

GaussianPly JoinedParts(const std::vector<SplatPart>& parts, unsigned half_turn, const std::string& file) {
  int64_t n = 0;
  int degree = 0;
  for (const SplatPart& part : parts) {
    n += part.gaussians.size();
    degree = std::max(degree, part.degree);
  }
  GaussianPly splat = ZeroSplat(n, degree, file);
  int64_t row = 0;
  for (const SplatPart& part : parts) {
    std::vector<Buffer<float>> from;
    part.gaussians.ForEach([&](const char*, const Buffer<float>& b) { from.push_back(b); });
    size_t i = 0;
    splat.gaussians.ForEach(
        [&](const char*, Buffer<float>& to) { to.Rows(row, row + part.gaussians.size()).CopyFrom(from[i++]); });
    row += part.gaussians.size();
    splat.marks.support.insert(splat.marks.support.end(), part.support.begin(), part.support.end());
  }
  if (static_cast<int64_t>(splat.marks.support.size()) != n) splat.marks.support.clear();
  const GaussianRows all = splat.gaussians.Rows();
  ParallelBlocks(n, kSplatGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) TurnHalf(all.From(i), half_turn);
  });
  return splat;
}

}  // namespace oraclegs
