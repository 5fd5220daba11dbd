#include "oraclegs/sfm/retry_schedule.h"

#include <fmt/format.h>

#include <algorithm>

#include "oraclegs/sfm/choose_pairs.h"

namespace oraclegs {
namespace {

constexpr int kMinGroup = 3;  // photos that are linked in pairs alone show as many places: no features join them
constexpr double kWideAngleFocal = .75;  // 27 mm on 36 mm: the main camera of most phones

ColmapOptions Joined(ColmapOptions options, const ColmapOptions& more) {
  for (const auto& [name, value] : more) options[name] = value;
  return options;
}

/// Without limits to the focal length the mapper explains wrong matches of few images by one of twenty widths.
ColmapOptions Common() {
  return {{"Mapper.min_model_size", "2"},
          {"Mapper.tri_ignore_two_view_tracks", "0"},  // few images: most points are seen twice only
          {"Mapper.min_focal_length_ratio", fmt::format("{}", kFocalRange[0])},
          {"Mapper.max_focal_length_ratio", fmt::format("{}", kFocalRange[1])}};
}

/// For images that barely overlap.
ColmapOptions Relaxed() {
  return Joined(Common(), {{"Mapper.min_num_matches", "10"},
                           {"Mapper.init_min_num_inliers", "50"},
                           {"Mapper.init_min_tri_angle", "4"},
                           {"Mapper.abs_pose_min_num_inliers", "15"},
                           {"Mapper.abs_pose_min_inlier_ratio", "0.15"}});
}

/// For two or three images side by side or one behind the other: small angles, few common points.
ColmapOptions TwoView() {
  return Joined(Relaxed(), {{"Mapper.min_num_matches", "8"},
                            {"Mapper.init_min_num_inliers", "20"},
                            {"Mapper.init_min_tri_angle", "1.5"},
                            {"Mapper.init_max_forward_motion", "1"},
                            {"Mapper.init_max_reg_trials", "4"},
                            {"Mapper.abs_pose_min_num_inliers", "10"},
                            {"Mapper.abs_pose_min_inlier_ratio", "0.1"},
                            {"Mapper.max_reg_trials", "6"},
                            {"Mapper.filter_min_tri_angle", "0.7"},
                            {"Mapper.tri_min_angle", "0.7"}});
}

std::vector<MapperAttempt> RelaxedAttempts() {
  return {
      {"relaxed", Relaxed(), 0}, {"two views", TwoView(), 0}, {"two views, wide angle", TwoView(), kWideAngleFocal}};
}

/// Adjusts a growing model seldom and briefly: many images hold each other.
ColmapOptions Quick() {
  return Joined(Common(), {{"Mapper.tri_ignore_two_view_tracks", "1"},
                           {"Mapper.ba_global_images_ratio", "1.4"},
                           {"Mapper.ba_global_points_ratio", "1.4"},
                           {"Mapper.ba_global_max_num_iterations", "25"},
                           {"Mapper.ba_global_max_refinements", "2"}});
}

std::vector<FeatureSet> MakeScheduleOfMany() {
  const FeatureSet coarse{"coarse features of many photos",
                          {{"SiftExtraction.first_octave", "0"}, {"SiftExtraction.max_num_features", "3000"}},
                          {},
                          {{"quick", Quick(), 0}},
                          1 << 30};
  return {coarse, {"usual features", {}, {}, {{"strict", Common(), 0}, {"relaxed", Relaxed(), 0}}, 1 << 30}};
}

std::vector<FeatureSet> MakeSchedule() {
  FeatureSet usual{"usual features", {}, {}, RelaxedAttempts(), 1 << 30};
  usual.attempts.insert(usual.attempts.begin(), {"strict", Common(), 0});
  FeatureSet learned{"learned features", {}, {}, RelaxedAttempts(), kMaxImagesForRetries};
  learned.is_learned = true;
  const FeatureSet coarse{"coarse features",
                          {{"SiftExtraction.estimate_affine_shape", "1"},
                           {"SiftExtraction.peak_threshold", "0.003"},
                           {"SiftExtraction.max_image_size", "1000"},
                           {"SiftExtraction.max_num_features", "2048"}},
                          {{"SiftMatching.max_ratio", "0.85"}},
                          RelaxedAttempts(),
                          kMaxImagesForRetries};
  // Weaker features are found by lowering the threshold. Guided matching, which would also add some, needs known
  // intrinsics: without them it follows a homography and keeps what lies on one plane.
  const FeatureSet more{"more features",
                        {{"SiftExtraction.peak_threshold", "0.002"}, {"SiftExtraction.max_num_features", "16384"}},
                        {{"SiftMatching.max_ratio", "0.85"}},
                        RelaxedAttempts(),
                        12,
                        true};
  const FeatureSet affine{"affine features",
                          {{"SiftExtraction.estimate_affine_shape", "1"}, {"SiftExtraction.peak_threshold", "0.003"}},
                          {{"SiftMatching.max_ratio", "0.85"}},
                          RelaxedAttempts(),
                          12,
                          true};
  const FeatureSet pooled{"pooled features",
                          {{"SiftExtraction.domain_size_pooling", "1"},
                           {"SiftExtraction.estimate_affine_shape", "1"},
                           {"SiftExtraction.peak_threshold", "0.003"}},
                          {{"SiftMatching.max_ratio", "0.85"}},
                          RelaxedAttempts(),
                          6,
                          true};
  return {usual, learned, coarse, more, affine, pooled};
}

}  // namespace

const std::vector<FeatureSet>& RegistrationSchedule(int images) {
  static const std::vector<FeatureSet> of_few = MakeSchedule(), of_many = MakeScheduleOfMany();
  return images > kMaxImagesToMatchAll ? of_many : of_few;
}

const ColmapOptions& RemainingImagesOptions() {
  static const ColmapOptions options = Joined(TwoView(), {{"Mapper.abs_pose_max_error", "16"}});
  return options;
}

const ColmapOptions& RematchOptions() {
  static const ColmapOptions options{{"SiftMatching.max_ratio", "0.9"},
                                     {"SiftMatching.guided_matching", "1"},
                                     {"SiftMatching.min_num_inliers", "10"},
                                     {"SiftMatching.min_inlier_ratio", "0.15"}};
  return options;
}

bool IsEnough(const ModelQuality& best, int images) {
  if (!IsSound(best)) return false;
  if (images > kMaxImagesToMatchAll) return 10 * best.registered() >= 9 * images;
  return best.registered() >= images || (images > kMaxImagesForRetries && 2 * best.registered() >= images);
}

MatchEvidence EvidenceOf(const ImageLinks& links, const ModelQuality& best, bool one_place) {
  const auto is_registered = [&](const std::string& name) { return IsSound(best) && best.images.count(name) > 0; };
  MatchEvidence evidence{0, one_place, 0};
  std::map<std::string, std::string> parents;  // of images in one group; a root is its own
  const auto root = [&](std::string name) {
    while (parents.at(name) != name) name = parents.at(name);
    return name;
  };
  const auto join = [&](const std::string& a, const std::string& b) {
    parents.emplace(a, a);
    parents.emplace(b, b);
    parents[root(a)] = root(b);
  };
  if (IsSound(best)) {
    for (const auto& [name, image] : best.images) join(name, best.images.begin()->first);
  }
  for (const auto& [a, b] : links) {
    join(a, b);
    if (!is_registered(a) || !is_registered(b)) ++evidence.links;
  }
  std::map<std::string, std::pair<int, bool>> groups;  // images, and whether one is missing
  for (const auto& [name, parent] : parents) {
    auto& [size, lacks] = groups[root(name)];
    ++size;
    lacks |= !is_registered(name);
  }
  for (const auto& [name, group] : groups) {
    if (group.second) evidence.group = std::max(evidence.group, group.first);
  }
  return evidence;
}

bool LinksMakeAModel(const MatchEvidence& evidence, int images) {
  return evidence.links > 0 && evidence.group >= std::min(images - 1, kMinGroup);
}

bool IsWorthTrying(const FeatureSet& set, const ModelQuality& best, int images, const MatchEvidence& evidence) {
  if (IsEnough(best, images) || images > set.max_images || evidence.one_place) return false;
  return !set.needs_link || LinksMakeAModel(evidence, images);
}

bool CanMatchMissing(const std::map<std::string, int>& feature_counts, const ModelQuality& best) {
  return std::any_of(feature_counts.begin(), feature_counts.end(), [&](const auto& entry) {
    return entry.second >= kMinFeaturesToMatch && (!IsSound(best) || best.images.count(entry.first) == 0);
  });
}

std::vector<std::pair<std::string, std::string>> PairsOfMissing(const std::vector<std::string>& names,
                                                                const ModelQuality& best) {
  const auto missing = [&](const std::string& name) { return best.images.count(name) == 0; };
  std::vector<std::pair<std::string, std::string>> pairs;
  for (size_t i = 0; i < names.size(); ++i) {
    for (size_t j = i + 1; j < names.size(); ++j) {
      if (missing(names[i]) || missing(names[j])) pairs.emplace_back(names[i], names[j]);
    }
  }
  if (pairs.size() > static_cast<size_t>(kMaxPairsToRematch)) pairs.clear();
  return pairs;
}

}  // namespace oraclegs
