// Lists of views: a file of them, the text of --train-views, and that of --scale.

#include <nlohmann/json.hpp>

#include "fuzz/fuzz.h"
#include "oraclegs/scene/frame_comments.h"
#include "oraclegs/scene/split.h"
#include "oraclegs/scene/view_list.h"

namespace {

oraclegs::Scene SceneOfNames() {
  oraclegs::Scene scene;
  scene.root = "scene";
  scene.format = oraclegs::SceneFormat::kColmap;
  for (const char* name : {"a/1.jpg", "a/2.jpg", "b/1.png", "r_10.png", "r_9.png"}) {
    oraclegs::SceneView view;
    view.name = name;
    view.image_path = name;
    view.cam_from_world = Eigen::Isometry3d::Identity();
    view.cam_from_world->translation().x() = static_cast<double>(scene.views.size());
    scene.views.push_back(view);
  }
  scene.missing_images = {"gone.jpg"};
  return scene;
}

/// Header comments of a splat, the first of which states the length of a unit.
std::vector<std::string> FuzzComments(const std::string& text) { return {"a unit is " + text + " m", text}; }

}  // namespace

ORACLEGS_FUZZ_TARGET(view_list) {
  using namespace oraclegs;
  static const fuzz::Folder folder;
  static const Scene scene = SceneOfNames();
  const auto parts = fuzz::Parts(bytes);
  const std::string file = folder.Put("list", parts[0]), option(fuzz::PartAt(parts, 1)), scale(fuzz::PartAt(parts, 2));
  fuzz::Try([&] { NamedViews(scene, "--train-views", ExpandViewList("@" + file, "train")); });
  fuzz::Try([&] { NamedViews(scene, "--train-views", option); });
  fuzz::Try([&] {
    SplitOptions options;
    options.test_views = "@" + file;
    options.train_views = option.starts_with('@') ? "" : option;
    SplitToJson(scene, SplitViews(scene, WithListsRead(options)));
  });
  fuzz::Try([&] { CheckScale(scale); });
  fuzz::Try([&] { CheckScale(scene, scale); });
  fuzz::Try([&] { UnitMeters(scene, scale, /*arbitrary=*/false); });
  fuzz::Try([&] { UnitMeters(scene, scale, /*arbitrary=*/true); });
  fuzz::Try([&] { UnitMetersOf(FuzzComments(scale)); });
}
