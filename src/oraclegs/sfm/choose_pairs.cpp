#include "oraclegs/sfm/choose_pairs.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "oraclegs/sfm/colmap_database.h"
#include "oraclegs/sfm/image_descriptions.h"

namespace oraclegs {
namespace {

constexpr int kDescriptorsOfImage = 1000;  // the largest ones

int64_t AllPairs(int images) { return int64_t{images} * (images - 1) / 2; }

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

}  // namespace oraclegs
