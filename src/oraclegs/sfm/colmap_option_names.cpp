#include "oraclegs/sfm/colmap_option_names.h"

#include <algorithm>
#include <string_view>
#include <utility>

namespace oraclegs {
namespace {

/// Names of COLMAP 3.8, and those of newer versions.
constexpr std::pair<std::string_view, std::string_view> kNewNames[] = {
    {"SiftExtraction.use_gpu", "FeatureExtraction.use_gpu"},
    {"SiftExtraction.num_threads", "FeatureExtraction.num_threads"},
    {"SiftExtraction.max_image_size", "FeatureExtraction.max_image_size"},
    {"SiftMatching.use_gpu", "FeatureMatching.use_gpu"},
    {"SiftMatching.num_threads", "FeatureMatching.num_threads"},
    {"SiftMatching.guided_matching", "FeatureMatching.guided_matching"},
    {"SiftMatching.min_num_inliers", "TwoViewGeometry.min_num_inliers"},
    {"SiftMatching.min_inlier_ratio", "TwoViewGeometry.min_inlier_ratio"},
    {"Mapper.fix_existing_images", "Mapper.fix_existing_frames"},
};

std::string_view NewName(std::string_view option) {
  for (const auto& [old_name, new_name] : kNewNames) {
    if (option == old_name) return new_name;
  }
  return "";
}

}  // namespace

std::string RefusedNames::NameFor(const std::string& colmap, const std::string& option) {
  const std::lock_guard lock(mutex_);
  return refused_[colmap].count(option) > 0 ? std::string(NewName(option)) : option;
}

bool RefusedNames::Learn(const std::string& colmap, const std::string& last_line) {
  constexpr std::string_view kRefusal = " option '--";
  const size_t begin = last_line.find(kRefusal);
  if (begin == std::string::npos) return false;
  std::string option = last_line.substr(begin + kRefusal.size());
  option.resize(std::min(option.size(), option.find('\'')));
  const std::lock_guard lock(mutex_);
  return !NewName(option).empty() && refused_[colmap].insert(std::move(option)).second;
}

}  // namespace oraclegs
