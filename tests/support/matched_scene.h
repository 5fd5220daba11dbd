#pragma once
// A posed scene with what was verified between its photos, out of a ring of known cameras.

#include <string>
#include <vector>

#include "oraclegs/sfm/pose_fit.h"
#include "support/matched_ring.h"

namespace oraclegs {

struct MatchedScene {
  Scene scene;
  std::vector<StagedView> plan;
  std::vector<VerifiedPair> verified;

  PoseFit Fit() const { return FitPoses(scene, AllViews(scene), plan, verified, {0, 0, 0}); }
  void SetPoses(const std::vector<Eigen::Isometry3d>& cams_from_world) {
    for (size_t i = 0; i < cams_from_world.size(); ++i) scene.views[i].cam_from_world = cams_from_world[i];
  }
};

/// n photos, each matched with the next three.
inline MatchedScene MakeMatchedScene(int n, int matches) {
  const MatchedRing ring = MakeMatchedRing(n, matches);
  MatchedScene out;
  out.scene.root = "/scene";
  out.scene.format = SceneFormat::kTransforms;
  for (int i = 0; i < n; ++i) {
    SceneView view;
    view.name = "photo" + std::to_string(i) + ".jpg";
    view.image_path = "/scene/images/" + view.name;
    view.intrinsics = ring.intrinsics[static_cast<size_t>(i)];
    view.cam_from_world = ring.cams_from_world[static_cast<size_t>(i)];
    out.scene.views.push_back(view);
    out.plan.push_back({"camera0/" + view.name, 0, false});
  }
  for (const ViewPair& pair : ring.pairs) {
    out.verified.push_back({out.plan[static_cast<size_t>(pair.a)].name, out.plan[static_cast<size_t>(pair.b)].name,
                            TwoViewConfig::kCalibrated, pair.matches});
  }
  return out;
}

}  // namespace oraclegs
