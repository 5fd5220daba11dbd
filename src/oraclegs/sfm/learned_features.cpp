#include "oraclegs/sfm/learned_features.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <string>
#include <utility>

#include "oraclegs/core/files.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/sfm/colmap_database.h"
#include "oraclegs/sfm/match_descriptors.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

/// An image of the database with its learned features; the first of them stands behind `first` others.
struct DescribedImage {
  std::string name;
  uint32_t id = 0;
  int first = 0;
  Buffer<float> descriptors;
};

Image8 WithoutAlpha(Image8 image) {
  if (image.channels == 3) return image;
  Image8 rgb{image.width, image.height, 3, {}};
  for (size_t i = 0; i < image.data.size(); i += static_cast<size_t>(image.channels)) {
    for (size_t c = 0; c < 3; ++c) rgb.data.push_back(image.data[i + c]);
  }
  return rgb;
}

/// Leaves out the keypoints where the mask, if there is one, is black.
void LeaveOutMasked(const fs::path& mask, LearnedFeatures* features) {
  if (!IsFile(mask)) return;
  const Image8 pixels = ReadImage(mask, Orientation::kAsStored);
  const int64_t size = features->descriptors.size(1);
  int64_t kept = 0;
  for (size_t i = 0; i < features->keypoints.size(); ++i) {
    const Eigen::Vector2f& keypoint = features->keypoints[i];
    const int x = std::clamp(static_cast<int>(keypoint.x()), 0, pixels.width - 1);
    const int y = std::clamp(static_cast<int>(keypoint.y()), 0, pixels.height - 1);
    if (pixels.data[(static_cast<size_t>(y) * pixels.width + x) * pixels.channels] == 0) continue;
    std::copy_n(features->descriptors.data() + static_cast<int64_t>(i) * size, size,
                features->descriptors.data() + kept * size);
    features->keypoints[static_cast<size_t>(kept++)] = keypoint;
  }
  features->keypoints.resize(static_cast<size_t>(kept));
  features->descriptors = features->descriptors.Rows(0, kept);
}

std::vector<DescribedImage> DescribeAll(const ColmapRunner& colmap, const FeatureFinder& find,
                                        const Listener& listener) {
  const auto stored = ReadDatabaseImages(colmap.database());
  std::vector<DescribedImage> images;
  for (const auto& [name, image] : stored) {
    ThrowIfInterrupted();
    LearnedFeatures features = find(ToFloat(WithoutAlpha(ReadImage(colmap.images() / name, Orientation::kAsStored))));
    LeaveOutMasked(colmap.images().parent_path() / "masks" / (name + ".png"), &features);
    const int first = AppendKeypoints(colmap.database(), image.image_id, features.keypoints);
    images.push_back({name, image.image_id, first, std::move(features.descriptors)});
    listener(StepDone{"register", static_cast<int64_t>(images.size()), static_cast<int64_t>(stored.size()), "images",
                      colmap.label() + "finding learned features"});
  }
  return images;
}

}  // namespace

void AddLearnedFeatures(const ColmapRunner& colmap, const FeatureFinder& find, const Listener& listener) {
  const std::vector<DescribedImage> images = DescribeAll(colmap, find, listener);
  std::string list;
  std::vector<std::pair<uint32_t, uint32_t>> pairs;
  const auto all = static_cast<int64_t>(images.size() * (images.size() - 1) / 2);
  int64_t done = 0;
  for (size_t i = 0; i < images.size(); ++i) {
    for (size_t j = i + 1; j < images.size(); ++j) {
      ThrowIfInterrupted();
      const bool in_order = images[i].id < images[j].id;
      const DescribedImage &a = images[in_order ? i : j], &b = images[in_order ? j : i];
      std::string lines;
      for (const FeatureMatch& match : ReadMatches(colmap.database(), a.id, b.id)) {
        fmt::format_to(std::back_inserter(lines), "{} {}\n", match.a, match.b);
      }
      for (const FeatureMatch& match : MatchDescriptors(a.descriptors, b.descriptors)) {
        fmt::format_to(std::back_inserter(lines), "{} {}\n", a.first + match.a, b.first + match.b);
      }
      listener(StepDone{"register", ++done, all, "pairs", colmap.label() + "matching learned features"});
      if (lines.empty()) continue;
      list += fmt::format("{} {}\n{}\n", a.name, b.name, lines);
      pairs.emplace_back(a.id, b.id);
    }
  }
  if (pairs.empty()) return;
  RemoveMatches(colmap.database(), pairs);
  const fs::path path = colmap.database().parent_path() / "matches.txt";
  WriteFileAtomically(path, list);
  colmap.ImportMatches(path, static_cast<int64_t>(pairs.size()), "verifying matches");
}

}  // namespace oraclegs
