#include "oraclegs/sfm/registration_report.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

#include "oraclegs/sfm/retry_schedule.h"

namespace oraclegs {
namespace {

constexpr int kPoorFeatures = 150;   // a sharp, textured photograph has thousands
constexpr int kEnoughMatches = 30;   // what colmap asks for to register a photograph with its own thresholds
constexpr double kWeakParallax = 1;  // degrees; depth is known to a few percent at best
constexpr size_t kNeighboursTold = 5;
constexpr size_t kMissingTold = 5;
constexpr int kFocalSteps = 24;
constexpr double kShortestFocal = .5, kLongestFocal = 2.5;  // longer sides of the picture

/// Names are in the order they were taken in, as a rule: the registered ones on both sides, nearest first.
std::vector<std::string> RegisteredAround(const RegistrationReport& report, size_t index) {
  std::vector<std::string> names;
  for (size_t step = 1; step < report.photos.size(); ++step) {
    for (const size_t other : {index - step, index + step}) {  // wraps around below zero: beyond the end
      if (other >= report.photos.size() || report.photos[other].verdict != PhotoVerdict::kRegistered) continue;
      names.push_back(report.photos[other].name);
    }
  }
  return names;
}

PhotoVerdict VerdictOfMissing(const PhotoReport& photo) {
  if (!photo.same_as.empty()) return PhotoVerdict::kSamePhotograph;
  const int most = photo.neighbours.empty() ? 0 : photo.neighbours[0].inliers;
  if (photo.features < kFewestFeatures || (photo.features < kPoorFeatures && most < kEnoughMatches)) {
    return PhotoVerdict::kFewFeatures;
  }
  if (most == 0) return PhotoVerdict::kNoMatches;
  if (most < kEnoughMatches) return PhotoVerdict::kFewMatches;
  const bool turned = std::all_of(photo.neighbours.begin(), photo.neighbours.end(),
                                  [](const Neighbour& n) { return n.turned_only || n.inliers < kEnoughMatches; });
  return turned ? PhotoVerdict::kTurnedOnTheSpot : PhotoVerdict::kDoesNotFit;
}

std::string Advice(const RegistrationReport& report, size_t index) {
  const PhotoReport& photo = report.photos[index];
  const std::vector<std::string> around = RegisteredAround(report, index);
  switch (photo.verdict) {
    case PhotoVerdict::kRegistered:
      if (photo.parallax_degrees >= kWeakParallax) return {};
      return "its depth is weak: take one more a step to the side, pointing at the same thing";
    case PhotoVerdict::kSamePhotograph:
      return "leave it out, or take one from another place";
    case PhotoVerdict::kFewFeatures:
      return fmt::format(
          "this photograph has only {} features: blurred, dark or without texture; take it again sharp, "
          "with textured things in view",
          photo.features);
    case PhotoVerdict::kNoMatches:
      if (around.empty()) return "take photographs that overlap with it by more than half";
      if (around.size() == 1) return fmt::format("take one between {} and {}", around[0], photo.name);
      return fmt::format("take one between {} and {}, and one between it and {}", around[0], photo.name, around[1]);
    case PhotoVerdict::kFewMatches:
    case PhotoVerdict::kDoesNotFit:
      return fmt::format("take one between {} and {}", photo.neighbours[0].name, photo.name);
    case PhotoVerdict::kTurnedOnTheSpot:
      return "move sideways, do not turn on the spot";
  }
  return {};
}

std::string VerdictWord(PhotoVerdict verdict) {
  switch (verdict) {
    case PhotoVerdict::kRegistered:
      return "registered";
    case PhotoVerdict::kSamePhotograph:
      return "same_photograph";
    case PhotoVerdict::kFewFeatures:
      return "few_features";
    case PhotoVerdict::kNoMatches:
      return "no_matches";
    case PhotoVerdict::kFewMatches:
      return "few_matches";
    case PhotoVerdict::kTurnedOnTheSpot:
      return "turned_on_the_spot";
    case PhotoVerdict::kDoesNotFit:
      return "does_not_fit";
  }
  return {};
}

std::string Why(const PhotoReport& photo) {
  switch (photo.verdict) {
    case PhotoVerdict::kRegistered:
      return {};
    case PhotoVerdict::kSamePhotograph:
      return fmt::format("the same photograph as {}", photo.same_as);
    case PhotoVerdict::kFewFeatures:
      return fmt::format("{} features: blurred, dark or without texture", photo.features);
    case PhotoVerdict::kNoMatches:
      return "no matches with any other";
    case PhotoVerdict::kFewMatches:
      return fmt::format("only {} matches with {}, fewer with others", photo.neighbours[0].inliers,
                         photo.neighbours[0].name);
    case PhotoVerdict::kTurnedOnTheSpot:
      return fmt::format("taken from the place of {}: no parallax", photo.neighbours[0].name);
    case PhotoVerdict::kDoesNotFit:
      return fmt::format("{} matches with {}, but too few to place it", photo.neighbours[0].inliers,
                         photo.neighbours[0].name);
  }
  return {};
}

nlohmann::json PhotoToJson(const PhotoReport& photo) {
  nlohmann::json neighbours = nlohmann::json::array();
  for (size_t i = 0; i < std::min(photo.neighbours.size(), kNeighboursTold); ++i) {
    const Neighbour& n = photo.neighbours[i];
    neighbours.push_back({{"name", n.name}, {"inliers", n.inliers}, {"turned_only", n.turned_only}});
  }
  const bool registered = photo.verdict == PhotoVerdict::kRegistered;
  nlohmann::json json{{"name", photo.name},
                      {"registered", registered},
                      {"verdict", VerdictWord(photo.verdict)},
                      {"why", registered ? nlohmann::json(nullptr) : nlohmann::json(Why(photo))},
                      {"advice", photo.advice.empty() ? nlohmann::json(nullptr) : nlohmann::json(photo.advice)},
                      {"features", photo.features},
                      {"neighbours", std::move(neighbours)},
                      {"points", photo.points}};
  json["parallax_degrees"] = registered ? nlohmann::json(photo.parallax_degrees) : nlohmann::json(nullptr);
  return json;
}

void AddWarnings(RegistrationReport* report) {
  for (const PhotoReport& photo : report->photos) {
    if (photo.verdict != PhotoVerdict::kSamePhotograph) continue;
    report->warnings.push_back(
        fmt::format("{} is the same photograph as {} and is left out", photo.name, photo.same_as));
  }
  if (report->registered() >= 2 && report->model.parallax_degrees < kWeakParallax) {
    report->warnings.push_back(
        fmt::format("the photographs were taken from nearly one point (median parallax {:.2f} degrees), so depth is "
                    "uncertain; move sideways between photographs",
                    report->model.parallax_degrees));
  }
  const auto missing = static_cast<int>(report->photos.size()) - report->registered();
  if (missing == 0 || report->registered() < 2) return;
  std::string advice;
  for (const PhotoReport& photo : report->photos) {
    if (photo.verdict == PhotoVerdict::kRegistered || photo.verdict == PhotoVerdict::kSamePhotograph) continue;
    advice = "; " + photo.advice;
    break;
  }
  report->warnings.push_back(fmt::format("registered {} of {} photographs; not registered: {}{}", report->registered(),
                                         report->photos.size(), WhyMissing(*report), advice));
}

}  // namespace

int RegistrationReport::registered() const {
  return static_cast<int>(std::count_if(photos.begin(), photos.end(), [](const PhotoReport& photo) {
    return photo.verdict == PhotoVerdict::kRegistered;
  }));
}

double TurnResidual(const Eigen::Matrix3d& b_from_a, const std::array<int, 2>& size_a,
                    const std::array<int, 2>& size_b) {
  const auto intrinsics = [](const std::array<int, 2>& size, double sides) {
    const double focal = sides * std::max(size[0], size[1]);
    Eigen::Matrix3d k;
    k << focal, 0, size[0] / 2., 0, focal, size[1] / 2., 0, 0, 1;
    return k;
  };
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kFocalSteps; ++i) {
    const double sides = kShortestFocal * std::pow(kLongestFocal / kShortestFocal, i / (kFocalSteps - 1.));
    const Eigen::Matrix3d turn = intrinsics(size_b, sides).inverse() * b_from_a * intrinsics(size_a, sides);
    const double scale = std::cbrt(turn.determinant());
    if (!std::isfinite(scale) || scale == 0) continue;
    const Eigen::Vector3d singular = Eigen::JacobiSVD<Eigen::Matrix3d>(turn / scale).singularValues();
    least = std::min(least, (singular.array() - 1).abs().maxCoeff());
  }
  return least;
}

RegistrationReport MakeReport(std::vector<PhotoReport> photos, const AttemptResult& result) {
  RegistrationReport report{std::move(photos), result.best, result.attempts, {}};
  for (PhotoReport& photo : report.photos) {
    std::stable_sort(photo.neighbours.begin(), photo.neighbours.end(),
                     [](const Neighbour& a, const Neighbour& b) { return a.inliers > b.inliers; });
    const auto found = result.best.images.find(photo.name);
    if (found == result.best.images.end()) {
      photo.verdict = VerdictOfMissing(photo);
      continue;
    }
    photo.verdict = PhotoVerdict::kRegistered;
    photo.points = found->second.points;
    photo.parallax_degrees = found->second.parallax_degrees;
  }
  for (size_t i = 0; i < report.photos.size(); ++i) report.photos[i].advice = Advice(report, i);
  AddWarnings(&report);
  return report;
}

std::string WhyMissing(const RegistrationReport& report) {
  std::vector<std::string> parts;
  size_t missing = 0;
  for (const PhotoReport& photo : report.photos) {
    if (photo.verdict == PhotoVerdict::kRegistered) continue;
    if (++missing <= kMissingTold) parts.push_back(fmt::format("{} ({})", photo.name, Why(photo)));
  }
  std::string text = fmt::format("{}", fmt::join(parts, ", "));
  if (missing > kMissingTold) text += fmt::format(" and {} more", missing - kMissingTold);
  return text;
}

bool TakenFromOnePoint(const RegistrationReport& report) {
  bool any = false;
  for (const PhotoReport& photo : report.photos) {
    for (const Neighbour& n : photo.neighbours) {
      if (n.inliers < kEnoughMatches) continue;
      if (!n.turned_only) return false;
      any = true;
    }
  }
  return any;
}

nlohmann::json ReportToJson(const RegistrationReport& report) {
  nlohmann::json attempts = nlohmann::json::array(), photos = nlohmann::json::array();
  for (const AttemptRecord& a : report.attempts) {
    attempts.push_back({{"features", a.features},
                        {"name", a.name},
                        {"registered", a.registered},
                        {"points", a.points},
                        {"reprojection_error", a.reprojection_error},
                        {"parallax_degrees", a.parallax_degrees},
                        {"kept", a.kept}});
  }
  for (const PhotoReport& photo : report.photos) photos.push_back(PhotoToJson(photo));
  return {{"format", 1},
          {"photographs", report.photos.size()},
          {"registered", report.registered()},
          {"points", report.model.points},
          {"reprojection_error", report.model.reprojection_error},
          {"parallax_degrees", report.model.parallax_degrees},
          {"warnings", report.warnings},
          {"views", std::move(photos)},
          {"attempts", std::move(attempts)}};
}

}  // namespace oraclegs
