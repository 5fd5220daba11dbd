#pragma once
// The report on each photo after structure from motion: registered or why not, and what to take instead.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "oraclegs/sfm/mapper_attempts.h"

namespace oraclegs {

enum class ViewStatus {
  kRegistered,
  kDuplicate,     ///< shows what another photo shows, which is used in its place
  kFewFeatures,   ///< blurred, dark or without texture
  kNoMatches,     ///< with any other
  kFewMatches,    ///< too few with every other
  kPureRotation,  ///< all cameras that share something with it stand in one place: no parallax
  kElsewhere,     ///< shares things with photos that are not registered either, and with no other
  kNoCamera,      ///< matches place it only with a lens that there is not, or where its depth agrees with no other
  kDoesNotFit,    ///< enough matches, but no pose that agrees with the model
};

/// Another photo that shows the same things.
struct Neighbor {
  std::string name;
  int inliers = 0;             ///< matches that one motion of the camera explains
  bool pure_rotation = false;  ///< that motion is a pure rotation
};

struct ViewReport {
  std::string name;
  ViewStatus status = ViewStatus::kRegistered;
  std::string same_as;  ///< for kDuplicate
  int features = 0;
  std::vector<Neighbor> neighbors;  ///< at least one inlier, most first
  int points = 0;                   ///< points of the model that it sees
  double parallax_degrees = 0;      ///< median over them
  std::string advice;               ///< what to take instead, empty when nothing is wrong
};

struct RegistrationReport {
  std::vector<ViewReport> views;  ///< by name
  ModelQuality model;
  std::vector<AttemptRecord> attempts;
  std::vector<std::string> warnings;  ///< one line each, to be reported

  int registered() const;
};

/// Completes `views`, which have name, same_as, features and neighbors: status, points, parallax and advice follow
/// from what `result` registered (images of the model are named as the views).
RegistrationReport MakeReport(std::vector<ViewReport> views, const AttemptResult& result);

/// "a.jpg (12 features: ...), b.jpg (...)": why each missing photo is missing, at most five of them.
std::string WhyMissing(const RegistrationReport& report);

/// True when every pair of matching photos differs by a pure rotation.
bool TakenFromOnePoint(const RegistrationReport& report);

/// The content of sfm/registration.json, docs/formats.md.
nlohmann::json ReportToJson(const RegistrationReport& report);

}  // namespace oraclegs
