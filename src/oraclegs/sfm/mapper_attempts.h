#pragma once
// Runs the attempts of retry_schedule.h in a folder of structure from motion, and keeps the best model of all.

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/sfm/attempt_journal.h"
#include "oraclegs/sfm/colmap_quality.h"
#include "oraclegs/sfm/learned_features.h"

namespace oraclegs {

struct AttemptRequest {
  std::vector<std::string> names;  ///< names of the images below work_dir/images
  bool has_masks = false;
  std::filesystem::path work_dir;
  std::map<std::string, double> focal_priors = {};  ///< pixels, by name of the image, where EXIF says it
  bool known_cameras = false;                       ///< focal_priors are of all images, and exact; none has distortion
  std::map<std::string, std::string> spheres = {};  ///< by image that is a face of one (tie_spheres.h)
  FeatureFinder find_features = {};                 ///< a network's; empty = there is none
  ConfirmedShares confirmed_shares = {};            ///< finds misplaced images; empty = nothing does
};

struct AttemptResult {
  ModelQuality best;  ///< quality of the model in work_dir/sparse/0; unsound when there is none
  std::vector<AttemptRecord> attempts;
  std::vector<std::string> left_out = {};  ///< images without a camera that can be right
};

/// Follows the schedule until it is enough (of a sphere, two faces), or until the matches say that no more can help.
/// Steps that an earlier call, of the same images, finished in AttemptsFolder(work_dir) are not done again. Leaves the
/// best sound model in work_dir/sparse/0 and, as work_dir/database.db, the features and matches it was made from;
/// without a sound model the first set's. Throws ColmapFailure when the first set's features or matches fail; later
/// failures only end their attempt.
AttemptResult RunAttempts(const AttemptRequest& request, const Listener& listener);

}  // namespace oraclegs
