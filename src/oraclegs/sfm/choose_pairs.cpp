#include "oraclegs/sfm/choose_pairs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "oraclegs/core/parallel.h"
#include "oraclegs/sfm/colmap_database.h"

namespace oraclegs {
namespace {

constexpr int kDescriptorsOfImage = 1000;  // the largest ones

int64_t AllPairs(int images) { return int64_t{images} * (images - 1) / 2; }

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

int64_t PairsToMatch(int images) {
  if (images <= kMaxImagesToMatchAll) return AllPairs(images);
  return std::min<int64_t>(AllPairs(images), int64_t{images} * (kNextInOrder + kMaxAlike));
}

std::vector<std::pair<int, int>> ChoosePairs(const Eigen::MatrixXf& descriptions) {
  const auto images = static_cast<int>(descriptions.rows());
  const Eigen::MatrixXf alike = descriptions * descriptions.transpose();
  std::set<std::pair<int, int>> pairs;
  for (int i = 0; i < images; ++i) {
    for (int j = i + 1; j <= i + kNextInOrder && j < images; ++j) pairs.insert({i, j});
    std::vector<int> others(static_cast<size_t>(images));
    std::iota(others.begin(), others.end(), 0);
    std::erase_if(others, [&](int j) { return j == i || !(alike(i, j) > 0); });
    const auto most = std::min<size_t>(kMaxAlike, others.size());
    std::partial_sort(others.begin(), others.begin() + static_cast<std::ptrdiff_t>(most), others.end(),
                      [&](int a, int b) { return alike(i, a) > alike(i, b) || (alike(i, a) == alike(i, b) && a < b); });
    for (size_t k = 0; k < most; ++k) pairs.insert({std::min(i, others[k]), std::max(i, others[k])});
  }
  return {pairs.begin(), pairs.end()};
}

void MatchImages(const ColmapRunner& colmap, const ColmapOptions& options, const Listener& listener) {
  const auto stored = ReadDatabaseImages(colmap.database());
  const auto images = static_cast<int>(stored.size());
  if (images <= kMaxImagesToMatchAll) {
    colmap.MatchExhaustively(options);
    return;
  }
  std::vector<std::string> names;
  std::vector<DescriptorMatrix> descriptors;
  for (const auto& [name, image] : stored) {
    names.push_back(name);
    descriptors.push_back(ReadLargestDescriptors(colmap.database(), image.image_id, kDescriptorsOfImage));
  }
  std::vector<std::pair<std::string, std::string>> pairs;
  for (const auto& [i, j] : ChoosePairs(DescribeImages(descriptors))) {
    pairs.emplace_back(names[static_cast<size_t>(i)], names[static_cast<size_t>(j)]);
  }
  listener(Note{fmt::format(
      "{} photos: {} of {} pairs are matched, of neighbors in order and of photos that look alike; fewer photos are "
      "faster: --views {}, or a folder with every {}th",
      images, pairs.size(), AllPairs(images), kMaxImagesToMatchAll / 2,
      (images + kMaxImagesToMatchAll - 1) / kMaxImagesToMatchAll)});
  colmap.MatchPairs(pairs, options, "matching");
}

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
