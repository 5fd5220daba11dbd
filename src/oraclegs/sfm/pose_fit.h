#pragma once
// Given poses checked before anything is trained: how well they fit what was recognized in several photos, and which of
// the usual mistakes they fit better with (docs/method.md#given-poses).

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/scene/scene.h"
#include "oraclegs/sfm/colmap_staging.h"
#include "oraclegs/sfm/matched_features.h"
#include "oraclegs/sfm/photo_order.h"
#include "oraclegs/sfm/pose_mistakes.h"

namespace oraclegs {

/// How the matches of a view, or of all, fit.
struct FitOfView {
  std::string name;
  int matches = 0;
  int pairs = 0;     ///< views that it was matched with
  double error = 0;  ///< median, pixels of kReferenceSide
  double share = 0;  ///< fraction of the matches that fit
  double limit = 0;  ///< an error above it is one of the poses, not of the matches
  double side = 0;   ///< longer side of the photo, in pixels; of all: of the median photo

  bool IsOff() const { return error > limit; }
  /// The error in pixels of the photo.
  double ErrorInPhoto() const { return error * side / kReferenceSide; }
};

enum class PoseVerdict {
  kUnknown,   ///< too few matches to say anything
  kFit,       ///< matches fit as far as features can be located
  kOff,       ///< they nearly fit, or fit for some views only
  kHopeless,  ///< hardly any match fits, or most miss by a mistake that is known
};

struct PoseFit {
  FitOfView all;                 ///< without a name
  std::vector<FitOfView> views;  ///< fits of the checked views
  PoseVerdict verdict = PoseVerdict::kUnknown;
  /// The mistake with which far more matches fit, one of them at most.
  std::optional<ChangeFit> change;
  std::optional<PhotoOrder> order;
  std::optional<TurnedViews> turned;  ///< positions in `views`

  bool IsExplained() const { return change || order || turned; }

  /// Names of the views whose poses do not fit, the worst first.
  std::vector<std::string> NamesOff() const;
};

/// Holds what colmap verified between the photos of these views against their cameras. `plan` is their staging,
/// `origin` where the coordinates that the poses were given in have theirs, in the scene's.
PoseFit FitPoses(const Scene& scene, const std::vector<int>& views, const std::vector<StagedView>& plan,
                 const std::vector<VerifiedPair>& verified, const Eigen::Vector3d& origin);

/// Fit of the matches that TriangulatePoints left in work_dir; nothing where it left none, with a warning where they
/// are damaged.
std::optional<PoseFit> FitPosesOf(const Scene& scene, const std::vector<int>& views, const Eigen::Vector3d& origin,
                                  const std::filesystem::path& work_dir, const Listener& listener);

/// One line: how far the poses are off, in which views, by which mistake, and how to fix it; "" for poses that fit, or
/// of which nothing is known.
std::string DescribeMisfit(const Scene& scene, const PoseFit& fit);

/// {"verdict", "matches", "error_pixels", "share", "views": [{"name", "matches", "error_pixels", "share"}]}; errors in
/// pixels of the photos.
nlohmann::json ToJson(const PoseFit& fit);

}  // namespace oraclegs
