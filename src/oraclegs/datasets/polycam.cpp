#include "oraclegs/datasets/polycam.h"

#include <nlohmann/json.hpp>
#include <optional>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/datasets/dataset_images.h"
#include "oraclegs/datasets/pose_files.h"
#include "oraclegs/scene/transforms_frame.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr uint64_t kMaxCameraBytes = 1 << 20;

struct PolycamFolders {
  fs::path cameras, images;
};

std::optional<PolycamFolders> FindPolycam(const fs::path& root) {
  const PolycamFolders candidates[] = {
      {root / "keyframes/corrected_cameras", root / "keyframes/corrected_images"},
      {root / "keyframes/cameras", root / "keyframes/images"},
      {root / "corrected_cameras", root / "corrected_images"},
      {IsFolder(root / "confidence") ? root / "cameras" : fs::path(), root / "images"},
  };
  for (const PolycamFolders& folders : candidates) {
    if (IsFolder(folders.cameras) && IsFolder(folders.images) && !FilesThatEnd(folders.cameras, ".json").empty()) {
      return folders;
    }
  }
  return std::nullopt;
}

/// A camera of Polycam with the keys of a transforms.json, whose axes it shares.
json AsTransformsFrame(const json& camera) {
  json matrix = json::array();
  for (const char row : {'0', '1', '2'}) {
    json numbers = json::array();
    for (const char column : {'0', '1', '2', '3'}) {
      numbers.push_back(camera.value(std::string("t_") + row + column, json()));
    }
    matrix.push_back(numbers);
  }
  json frame = {{"transform_matrix", matrix}};
  const std::pair<const char*, const char*> kKeys[] = {{"fx", "fl_x"}, {"fy", "fl_y"}, {"cx", "cx"},
                                                       {"cy", "cy"},   {"width", "w"}, {"height", "h"}};
  for (const auto& [theirs, ours] : kKeys) frame[ours] = camera.value(theirs, json());
  return frame;
}

void FillPolycamCamera(const fs::path& path, SceneView* view) {
  json camera;
  try {
    camera = ParseJson(ReadFile(path, kMaxCameraBytes));
  } catch (const json::exception& error) {
    throw InputError("{}: is not valid JSON: {}", path.string(), error.what());
  }
  if (!camera.is_object()) throw InputError("{}: is no camera of Polycam; export the capture again", path.string());
  const json frame = AsTransformsFrame(camera), none = json::object();
  const TransformsFrame read{none, frame, path.string()};
  view->intrinsics = ReadTransformsIntrinsics(read, view->image_path);
  view->cam_from_world = ReadTransformsPose(read).cam_from_world;
}

/// Depth in millimeters that the phone measured, with its confidence. An export that has a folder of these has one for
/// each depth that is whole.
void AddPolycamDepth(const fs::path& folder, SceneView* view) {
  const std::string name = view->image_path.stem().string() + ".png";
  const fs::path depth = folder / "depth" / name, confidence = folder / "confidence" / name;
  const bool has_confidence = IsFile(confidence);
  if (!IsFile(depth) || (!has_confidence && IsFolder(folder / "confidence"))) return;
  view->depth_path = depth;
  if (has_confidence) view->confidence_path = confidence;
}

}  // namespace

bool IsPolycamScene(const fs::path& root) { return FindPolycam(root).has_value(); }

Scene ReadPolycamScene(const fs::path& root, const SceneReadOptions& options, const Listener& listener) {
  const auto [cameras, usual_images] = FindPolycam(root).value();
  const fs::path images = options.images.empty() ? usual_images : root / options.images;
  std::vector<SceneView> views;
  std::vector<std::string> unplaced;
  for (const fs::path& image : SortedImages(images)) {
    SceneView view;
    view.name = image.filename().string();
    view.image_path = image;
    const fs::path camera = cameras / (image.stem().string() + ".json");
    if (!IsFile(camera)) {
      unplaced.push_back(view.name);
      continue;
    }
    FillPolycamCamera(camera, &view);
    AddPolycamDepth(cameras.parent_path(), &view);
    views.push_back(std::move(view));
  }
  ReportUnplaced(cameras.string(), unplaced, listener);
  return SceneOfDataset(cameras, SceneFormat::kPolycam, std::move(views), images, listener);
}

}  // namespace oraclegs
