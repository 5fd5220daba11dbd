#pragma once
// Which pose belongs to which photo, where a list of poses may have been given in another order.

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/sfm/match_fit.h"

namespace oraclegs {

/// An order in which the matches fit.
struct PhotoOrder {
  std::vector<int> pose_of_view;  ///< for each checked view the index of its pose among `poses`
  std::string words;              ///< "reversed", "each pose stands 1 too late", ...; "" = in no such order
  double share = 0;               ///< fraction of the matches that fit within `limit` pixels
};

struct OrderSearch {
  std::vector<RayPair> pairs;            ///< matches of the checked views
  std::vector<int> views;                ///< index of each checked view among `names` and `poses`
  std::vector<std::string> names;        ///< names of all photos of the scene, sorted as numbers are counted
  std::vector<Eigen::Isometry3d> poses;  ///< poses of all photos, camera from world
  double limit = 0;                      ///< pixels within which a match fits
};

/// The order in which most matches fit: the usual ones (shifted, reversed, names sorted as text) or, among at most 64
/// photos, any other. Nothing when no order is better than the one that was given.
std::optional<PhotoOrder> FindPhotoOrder(const OrderSearch& search);

}  // namespace oraclegs
