#include "oraclegs/sfm/registration_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "oraclegs/sfm/pose_doubts.h"
#include "oraclegs/sfm/retry_schedule.h"

namespace oraclegs {
namespace {

constexpr int kMinFeatures = 150;           // a sharp, textured photo has thousands
constexpr int kMinMatchesToRegister = 30;   // what colmap asks for by default
constexpr double kMinParallaxForDepth = 1;  // degrees; depth is known to a few percent at best
constexpr size_t kMaxNeighborsReported = 5;
constexpr size_t kMaxMissingNamed = 5;

/// Names are in the order they were taken in, as a rule: the registered ones on both sides, nearest first.
std::vector<std::string> RegisteredAround(const RegistrationReport& report, size_t index) {
  std::vector<std::string> names;
  for (size_t step = 1; step < report.views.size(); ++step) {
    for (const size_t other : {index - step, index + step}) {  // wraps around below zero: beyond the end
      if (other >= report.views.size() || report.views[other].status != ViewStatus::kRegistered) continue;
      names.push_back(report.views[other].name);
    }
  }
  return names;
}

ViewStatus StatusOfMissing(const ViewReport& view, const AttemptResult& result) {
  const std::map<std::string, RegisteredImage>& registered = result.best.images;
  if (!view.same_as.empty()) return ViewStatus::kDuplicate;
  if (std::count(result.left_out.begin(), result.left_out.end(), view.name) > 0) return ViewStatus::kNoCamera;
  const int most = view.neighbors.empty() ? 0 : view.neighbors[0].inliers;
  if (view.features < kMinFeaturesToMatch || (view.features < kMinFeatures && most < kMinMatchesToRegister)) {
    return ViewStatus::kFewFeatures;
  }
  if (most == 0) return ViewStatus::kNoMatches;
  if (most < kMinMatchesToRegister) return ViewStatus::kFewMatches;
  const bool pure_rotation = std::all_of(view.neighbors.begin(), view.neighbors.end(), [](const Neighbor& n) {
    return n.pure_rotation || n.inliers < kMinMatchesToRegister;
  });
  if (pure_rotation) return ViewStatus::kPureRotation;
  const bool elsewhere =
      !registered.empty() && std::all_of(view.neighbors.begin(), view.neighbors.end(), [&](const Neighbor& n) {
        return n.inliers < kMinMatchesToRegister || registered.count(n.name) == 0;
      });
  return elsewhere ? ViewStatus::kElsewhere : ViewStatus::kDoesNotFit;
}

std::string Advice(const RegistrationReport& report, size_t index) {
  const ViewReport& view = report.views[index];
  const std::vector<std::string> around = RegisteredAround(report, index);
  switch (view.status) {
    case ViewStatus::kRegistered:
      if (view.parallax_degrees >= kMinParallaxForDepth) return {};
      return "its depth is weak: take one more a step to the side, pointing at the same thing";
    case ViewStatus::kDuplicate:
      return "leave it out, or take one from another place";
    case ViewStatus::kFewFeatures:
      return fmt::format(
          "this photo has only {} features: blurred, dark or without texture; take it again sharp, "
          "with textured things in view",
          view.features);
    case ViewStatus::kNoMatches: {
      if (around.empty()) return "take photos that overlap with it by more than half";
      const std::string second = around.size() == 1 ? "" : fmt::format(", and one between it and {}", around[1]);
      return fmt::format("take one between {} and {}{}, or leave it out if it shows another place", around[0],
                         view.name, second);
    }
    case ViewStatus::kFewMatches:
    case ViewStatus::kDoesNotFit:
      return fmt::format("take one between {} and {}", view.neighbors[0].name, view.name);
    case ViewStatus::kElsewhere:
      return fmt::format("take photos between it and {}, or leave it out if it shows another place",
                         around.empty() ? "the registered ones" : around[0]);
    case ViewStatus::kNoCamera:
      return "take it again with the lens of the others, not cropped, and closer to one of them";
    case ViewStatus::kPureRotation:
      return "move sideways, do not only turn the camera";
  }
  return {};
}

std::string StatusWord(ViewStatus verdict) {
  switch (verdict) {
    case ViewStatus::kRegistered:
      return "registered";
    case ViewStatus::kDuplicate:
      return "duplicate";
    case ViewStatus::kFewFeatures:
      return "few_features";
    case ViewStatus::kNoMatches:
      return "no_matches";
    case ViewStatus::kFewMatches:
      return "few_matches";
    case ViewStatus::kPureRotation:
      return "pure_rotation";
    case ViewStatus::kElsewhere:
      return "elsewhere";
    case ViewStatus::kNoCamera:
      return "no_camera";
    case ViewStatus::kDoesNotFit:
      return "does_not_fit";
  }
  return {};
}

std::string Why(const ViewReport& view) {
  switch (view.status) {
    case ViewStatus::kRegistered:
      return {};
    case ViewStatus::kDuplicate:
      return fmt::format("the same photo as {}", view.same_as);
    case ViewStatus::kFewFeatures:
      return fmt::format("{} features: blurred, dark or without texture", view.features);
    case ViewStatus::kNoMatches:
      return "no matches with any other";
    case ViewStatus::kFewMatches:
      return fmt::format("only {} matches with {}, fewer with others", view.neighbors[0].inliers,
                         view.neighbors[0].name);
    case ViewStatus::kPureRotation:
      return fmt::format("taken from the place of {}: no parallax", view.neighbors[0].name);
    case ViewStatus::kElsewhere:
      return fmt::format("{} matches with {}, but hardly any with a registered photo", view.neighbors[0].inliers,
                         view.neighbors[0].name);
    case ViewStatus::kNoCamera:
      return "its matches ask for a lens that there is not, or for a place where its depth agrees with no other photo";
    case ViewStatus::kDoesNotFit:
      return fmt::format("{} matches with {}, but they fit no place beside the others", view.neighbors[0].inliers,
                         view.neighbors[0].name);
  }
  return {};
}

nlohmann::json ViewToJson(const ViewReport& view) {
  nlohmann::json neighbors = nlohmann::json::array();
  for (size_t i = 0; i < std::min(view.neighbors.size(), kMaxNeighborsReported); ++i) {
    const Neighbor& n = view.neighbors[i];
    neighbors.push_back({{"name", n.name}, {"inliers", n.inliers}, {"pure_rotation", n.pure_rotation}});
  }
  const bool registered = view.status == ViewStatus::kRegistered;
  nlohmann::json json{{"name", view.name},
                      {"registered", registered},
                      {"status", StatusWord(view.status)},
                      {"why", registered ? nlohmann::json(nullptr) : nlohmann::json(Why(view))},
                      {"advice", view.advice.empty() ? nlohmann::json(nullptr) : nlohmann::json(view.advice)},
                      {"features", view.features},
                      {"neighbors", std::move(neighbors)},
                      {"points", view.points}};
  json["parallax_degrees"] = registered ? nlohmann::json(view.parallax_degrees) : nlohmann::json(nullptr);
  return json;
}

/// Why a model was kept, or another one was.
std::string WhyKept(const AttemptRecord& attempt, const RegistrationReport& report) {
  if (attempt.kept) return "the best model";
  if (attempt.registered == 0) return "it found no model";
  if (!attempt.flaw.empty()) return attempt.flaw;
  if (attempt.registered > report.registered()) return "some of its photos stand at wrong places";
  if (attempt.registered < report.registered()) return "the best model has more photos";
  if (attempt.points < report.model.points) return "the best model has more points";
  return "the best model fits more closely";
}

void AddWarnings(RegistrationReport* report) {
  for (const ViewReport& view : report->views) {
    if (view.status != ViewStatus::kDuplicate) continue;
    report->warnings.push_back(fmt::format("{} is the same photo as {} and is left out", view.name, view.same_as));
  }
  if (report->registered() >= 2 && report->model.parallax_degrees < kMinParallaxForDepth) {
    report->warnings.push_back(
        fmt::format("the photos were taken from nearly one point (median parallax {:.2f} degrees), so depth is "
                    "uncertain; move sideways between photos",
                    report->model.parallax_degrees));
  }
  for (const ViewReport& view : report->views) {
    const auto found = report->model.images.find(view.name);
    if (found == report->model.images.end() || found->second.nearest_degrees < kMaxDegreesOfSift) continue;
    report->warnings.push_back(fmt::format(
        "{}{} sees what it shares with others from {:.0f} degrees away from them, where features are hardly "
        "recognized, so that it may stand at a wrong place; take a photo between it and {}",
        kPosesDoubtful, view.name, found->second.nearest_degrees,
        view.neighbors.empty() ? "the others" : view.neighbors[0].name));
  }
  const auto missing = static_cast<int>(report->views.size()) - report->registered();
  if (missing == 0 || report->registered() < 2) return;
  std::string advice;
  for (const ViewReport& view : report->views) {
    if (view.status == ViewStatus::kRegistered || view.status == ViewStatus::kDuplicate) continue;
    advice = "; " + view.advice;
    break;
  }
  report->warnings.push_back(fmt::format("registered {} of {} photos; not registered: {}{}", report->registered(),
                                         report->views.size(), WhyMissing(*report), advice));
}

}  // namespace

int RegistrationReport::registered() const {
  return static_cast<int>(std::count_if(views.begin(), views.end(),
                                        [](const ViewReport& view) { return view.status == ViewStatus::kRegistered; }));
}

RegistrationReport MakeReport(std::vector<ViewReport> views, const AttemptResult& result) {
  RegistrationReport report{std::move(views), result.best, result.attempts, {}};
  for (ViewReport& view : report.views) {
    std::stable_sort(view.neighbors.begin(), view.neighbors.end(),
                     [](const Neighbor& a, const Neighbor& b) { return a.inliers > b.inliers; });
    const auto found = result.best.images.find(view.name);
    if (found == result.best.images.end()) {
      view.status = StatusOfMissing(view, result);
      continue;
    }
    view.status = ViewStatus::kRegistered;
    view.points = found->second.points;
    view.parallax_degrees = found->second.parallax_degrees;
  }
  for (size_t i = 0; i < report.views.size(); ++i) report.views[i].advice = Advice(report, i);
  AddWarnings(&report);
  return report;
}

std::string WhyMissing(const RegistrationReport& report) {
  std::vector<std::string> parts;
  size_t missing = 0;
  for (const ViewReport& view : report.views) {
    if (view.status == ViewStatus::kRegistered) continue;
    if (++missing <= kMaxMissingNamed) parts.push_back(fmt::format("{} ({})", view.name, Why(view)));
  }
  std::string text = fmt::format("{}", fmt::join(parts, ", "));
  if (missing > kMaxMissingNamed) text += fmt::format(" and {} more", missing - kMaxMissingNamed);
  return text;
}

bool TakenFromOnePoint(const RegistrationReport& report) {
  bool any = false;
  for (const ViewReport& view : report.views) {
    for (const Neighbor& n : view.neighbors) {
      if (n.inliers < kMinMatchesToRegister) continue;
      if (!n.pure_rotation) return false;
      any = true;
    }
  }
  return any;
}

nlohmann::json ReportToJson(const RegistrationReport& report) {
  nlohmann::json attempts = nlohmann::json::array(), views = nlohmann::json::array();
  for (const AttemptRecord& attempt : report.attempts) {
    attempts.push_back(RecordToJson(attempt));
    attempts.back().erase("flaw");
    attempts.back()["why"] = WhyKept(attempt, report);
  }
  for (const ViewReport& view : report.views) views.push_back(ViewToJson(view));
  return {{"format", 2},
          {"photos", report.views.size()},
          {"registered", report.registered()},
          {"points", report.model.points},
          {"reprojection_error", report.model.reprojection_error},
          {"parallax_degrees", report.model.parallax_degrees},
          {"warnings", report.warnings},
          {"views", std::move(views)},
          {"attempts", std::move(attempts)}};
}

}  // namespace oraclegs
