#pragma once
// The result of the check of given poses, in words for people and as JSON.

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "oraclegs/sfm/pose_fit.h"

namespace oraclegs {

/// One line: how far the poses are off, in which views, by which mistake, and how to fix it; "" for poses that fit, or
/// of which nothing is known.
std::string DescribeMisfit(const Scene& scene, const PoseFit& fit);

/// {"verdict", "matches", "error_pixels", "share", "views": [{"name", "matches", "error_pixels", "share"}]}; errors in
/// pixels of the photos.
nlohmann::json ToJson(const PoseFit& fit);

}  // namespace oraclegs
