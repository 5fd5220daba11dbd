#include "oraclegs/sfm/image_descriptions.h"

#include <algorithm>
#include <cmath>

#include "oraclegs/core/parallel.h"

namespace oraclegs {
namespace {

constexpr int kClusters = 32, kClusterRounds = 8;
constexpr Eigen::Index kSampledDescriptors = 12000;  // descriptors that the clusters are found among

/// Square roots of the parts of the sum: many alike features, as of leaves, then weigh less [Arandjelovic 2012].
DescriptorMatrix Rooted(DescriptorMatrix descriptors) {
  for (Eigen::Index i = 0; i < descriptors.rows(); ++i) {
    const float sum = descriptors.row(i).sum();
    if (sum > 0) descriptors.row(i) = (descriptors.row(i) / sum).cwiseSqrt();
  }
  return descriptors;
}

std::vector<Eigen::Index> NearestCenters(const DescriptorMatrix& descriptors, const DescriptorMatrix& centers) {
  const Eigen::VectorXf half_squares = .5F * centers.rowwise().squaredNorm();
  const Eigen::MatrixXf closeness = (descriptors * centers.transpose()).rowwise() - half_squares.transpose();
  std::vector<Eigen::Index> nearest(static_cast<size_t>(descriptors.rows()));
  for (Eigen::Index i = 0; i < descriptors.rows(); ++i) closeness.row(i).maxCoeff(&nearest[static_cast<size_t>(i)]);
  return nearest;
}

/// Evenly drawn from all images.
DescriptorMatrix Sample(const std::vector<DescriptorMatrix>& images) {
  Eigen::Index total = 0;
  for (const DescriptorMatrix& image : images) total += image.rows();
  const Eigen::Index step = std::max<Eigen::Index>(1, total / kSampledDescriptors);
  DescriptorMatrix sample((total + step - 1) / step, 128);
  Eigen::Index at = 0;
  for (const DescriptorMatrix& image : images) {
    for (Eigen::Index i = 0; i < image.rows(); ++i, ++at) {
      if (at % step == 0) sample.row(at / step) = image.row(i);
    }
  }
  return sample;
}

DescriptorMatrix FindCenters(const DescriptorMatrix& sample) {
  const Eigen::Index clusters = std::min<Eigen::Index>(kClusters, sample.rows());
  DescriptorMatrix centers(clusters, 128);
  if (clusters == 0) return centers;
  for (Eigen::Index c = 0; c < clusters; ++c) centers.row(c) = sample.row(c * sample.rows() / clusters);
  for (int round = 0; round < kClusterRounds; ++round) {
    const std::vector<Eigen::Index> nearest = NearestCenters(sample, centers);
    DescriptorMatrix sums = DescriptorMatrix::Zero(clusters, 128);
    Eigen::VectorXf counts = Eigen::VectorXf::Zero(clusters);
    for (Eigen::Index i = 0; i < sample.rows(); ++i) {
      sums.row(nearest[static_cast<size_t>(i)]) += sample.row(i);
      counts[nearest[static_cast<size_t>(i)]] += 1;
    }
    for (Eigen::Index c = 0; c < clusters; ++c) {
      if (counts[c] > 0) centers.row(c) = sums.row(c) / counts[c];
    }
  }
  return centers;
}

}  // namespace

Eigen::MatrixXf DescribeImages(const std::vector<DescriptorMatrix>& images) {
  std::vector<DescriptorMatrix> rooted;
  for (const DescriptorMatrix& image : images) rooted.push_back(Rooted(image));
  const DescriptorMatrix centers = FindCenters(Sample(rooted));
  Eigen::MatrixXf descriptions = Eigen::MatrixXf::Zero(static_cast<Eigen::Index>(images.size()), centers.rows() * 128);
  if (centers.rows() == 0) return descriptions;
  ParallelFor(static_cast<int64_t>(images.size()), [&](int64_t n) {
    const DescriptorMatrix& image = rooted[static_cast<size_t>(n)];
    if (image.rows() == 0) return;
    const std::vector<Eigen::Index> nearest = NearestCenters(image, centers);
    DescriptorMatrix residuals = DescriptorMatrix::Zero(centers.rows(), 128);
    for (Eigen::Index i = 0; i < image.rows(); ++i) {
      const Eigen::Index c = nearest[static_cast<size_t>(i)];
      residuals.row(c) += image.row(i) - centers.row(c);
    }
    for (Eigen::Index c = 0; c < centers.rows(); ++c) {
      const float norm = residuals.row(c).norm();
      if (norm > 0) residuals.row(c) /= norm;
      descriptions.row(n).segment(c * 128, 128) = residuals.row(c);
    }
    const float norm = descriptions.row(n).norm();
    if (norm > 0) descriptions.row(n) /= norm;
  });
  return descriptions;
}

}  // namespace oraclegs
