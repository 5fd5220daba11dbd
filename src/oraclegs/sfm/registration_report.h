#pragma once
// What is told of each photograph after structure from motion: registered or why not, and what to take instead.

#include <Eigen/Core>
#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "oraclegs/sfm/mapper_attempts.h"

namespace oraclegs {

enum class PhotoVerdict {
  kRegistered,
  kSamePhotograph,   ///< of another that counts in its place
  kFewFeatures,      ///< blurred, dark or without texture
  kNoMatches,        ///< with any other
  kFewMatches,       ///< too few with every other
  kTurnedOnTheSpot,  ///< what it shares with others it saw from their place: no parallax
  kDoesNotFit,       ///< enough matches, but no pose that agrees with the model
};

/// Another photograph that shows the same things.
struct Neighbour {
  std::string name;
  int inliers = 0;           ///< matches that one motion of the camera explains
  bool turned_only = false;  ///< that motion is a turn on the spot
};

struct PhotoReport {
  std::string name;
  PhotoVerdict verdict = PhotoVerdict::kRegistered;
  std::string same_as;  ///< for kSamePhotograph
  int features = 0;
  std::vector<Neighbour> neighbours;  ///< at least one inlier, most first
  int points = 0;                     ///< of the model that it sees
  double parallax_degrees = 0;        ///< median over them
  std::string advice;                 ///< what to take instead, empty when nothing is to be mended
};

struct RegistrationReport {
  std::vector<PhotoReport> photos;  ///< by name
  ModelQuality model;
  std::vector<AttemptRecord> attempts;
  std::vector<std::string> warnings;  ///< one line each, to be told

  int registered() const;
};

/// Distance of a homography from a turn of the camera on the spot, K_b R K_a^-1, over the focal lengths that cameras
/// have: the largest departure of a singular value of R from 1. A step aside by the t-th part of the distance to a
/// plane gives about t. Sizes are (width, height) in pixels. Infinite for a map that is no homography of two cameras.
double TurnResidual(const Eigen::Matrix3d& b_from_a, const std::array<int, 2>& size_a,
                    const std::array<int, 2>& size_b);

/// Judges photos whose verdict is open: `photos` come with name, same_as, features and neighbours; verdict, points,
/// parallax and advice are filled in by what `result` registered (images of the model are named as the photographs).
RegistrationReport MakeReport(std::vector<PhotoReport> photos, const AttemptResult& result);

/// "a.jpg (12 features: ...), b.jpg (...)": why each photograph that is missing is missing, at most five of them.
std::string WhyMissing(const RegistrationReport& report);

/// True when every pair of photographs that match differs by a turn on the spot.
bool TakenFromOnePoint(const RegistrationReport& report);

/// The content of sfm/registration.json, docs/formats.md.
nlohmann::json ReportToJson(const RegistrationReport& report);

}  // namespace oraclegs
