#pragma once
// The faces of a spherical photo have one center and known turns. COLMAP 3.8 finds their poses one by one; here they
// are tied together.

#include <Eigen/Geometry>
#include <filesystem>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/scene/scene.h"
#include "oraclegs/sfm/colmap_staging.h"

namespace oraclegs {

/// A face whose pose was found by itself.
struct FoundFace {
  Eigen::Matrix3d face_from_sphere;
  Eigen::Isometry3d cam_from_world;
  double weight = 1;  ///< above 0: points that it saw; what is misplaced sees few
};

/// The pose of a sphere (its frame: SphereFace) that most of its faces, one or more, agree on: medians of their centers
/// [Weiszfeld 1937] and rotations [Hartley 2011], which no single face far off moves much.
Eigen::Isometry3d SpherePose(const std::vector<FoundFace>& faces);

/// Replaces work_dir/sparse/0, a model of the staged views, by one in which all faces of each sphere that has a
/// registered one have exact poses and focal lengths: points triangulated anew, and spheres and points adjusted
/// together by rig_bundle_adjuster where this COLMAP has it. A sphere that hardly sees a point is placed again by those
/// of the others, or left out. False, and nothing done, without spheres. Throws
/// ColmapFailure when no points can be triangulated, RunError when work_dir cannot be written.
bool TieSpheres(const Scene& photos, const std::vector<int>& views, const std::vector<StagedView>& plan,
                const std::filesystem::path& work_dir, const Listener& listener);

}  // namespace oraclegs
