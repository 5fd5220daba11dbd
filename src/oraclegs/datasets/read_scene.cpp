#include "oraclegs/datasets/read_scene.h"

#include <algorithm>
#include <iterator>
#include <system_error>
#include <vector>

#include "oraclegs/core/error.h"
#include "oraclegs/core/text.h"
#include "oraclegs/datasets/bundler.h"
#include "oraclegs/datasets/llff.h"
#include "oraclegs/datasets/metashape.h"
#include "oraclegs/datasets/neus.h"
#include "oraclegs/datasets/point_file.h"
#include "oraclegs/datasets/polycam.h"
#include "oraclegs/datasets/reality_scan.h"
#include "oraclegs/datasets/record3d.h"
#include "oraclegs/scene/capture_layout.h"
#include "oraclegs/scene/find_model.h"
#include "oraclegs/scene/fit_cameras.h"
#include "oraclegs/scene/masks.h"
#include "oraclegs/scene/named_files.h"
#include "oraclegs/scene/photo_folder.h"
#include "oraclegs/scene/read_colmap.h"
#include "oraclegs/scene/spheres.h"
#include "oraclegs/scene/transforms.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

/// Throws unless the folder that the user named exists.
void RequireFolder(const fs::path& path, const char* fix) {
  std::error_code error;
  if (fs::is_directory(path, error)) return;
  if (path.string().find("://") != std::string::npos) {
    throw InputError("{}: is an address; download it, and name the file or folder", path.string());
  }
  throw InputError("{}: {}; {}", path.string(), fs::exists(path, error) ? "is not a folder" : "no such folder", fix);
}

/// Throws InputError unless all that the scene's own files name lies in its folder, or in the one that the user named.
/// Links are followed wherever they lead: a file's text cannot make one.
void RequireInside(const Scene& scene, const fs::path& root, const SceneReadOptions& options) {
  if (options.allow_outside) return;
  std::vector<fs::path> named{scene.point_file};
  for (const SceneView& view : scene.views) {
    named.insert(named.end(), {view.image_path, view.mask_path, view.depth_path, view.confidence_path});
  }
  for (const fs::path& path : named) {
    if (path.empty() || LiesIn(root, path)) continue;
    if (!options.images.empty() && LiesIn(root / options.images, path)) continue;
    throw InputError(
        "{}: names {}, which lies outside the scene's folder; move it there, or add --allow-outside if you trust the "
        "scene",
        root.string(), OneLine(path.string()));
  }
}

/// A format of other programs, known by what lies in its folder.
struct DatasetFormat {
  bool (*is)(const fs::path& root);
  Scene (*read)(const fs::path& root, const SceneReadOptions& options, const Listener& listener);
};

/// The format of a folder without a COLMAP model or JSON; null when it is none that is known.
const DatasetFormat* FindDataset(const fs::path& root) {
  static constexpr DatasetFormat kFormats[] = {
      {IsPolycamScene, ReadPolycamScene},     {IsRecord3dScene, ReadRecord3dScene},
      {IsLlffScene, ReadLlffScene},           {IsNeusScene, ReadNeusScene},
      {IsMetashapeScene, ReadMetashapeScene}, {IsRealityScanScene, ReadRealityScanScene},
      {IsBundlerScene, ReadBundlerScene}};
  const auto* found = std::find_if(std::begin(kFormats), std::end(kFormats),
                                   [&](const DatasetFormat& format) { return format.is(root); });
  return found == std::end(kFormats) ? nullptr : found;
}

Scene ReadPhotoFolder(const fs::path& root, const SceneReadOptions& options, const Listener& listener) {
  Scene scene;
  scene.format = SceneFormat::kPhotos;
  const auto layout = FindCaptureLayout(root);
  const fs::path usual = root / "images";
  std::error_code error;
  const bool is_usual = !layout || (layout->photos != usual && fs::is_directory(usual, error));
  if (!options.images.empty() || is_usual)
    scene.views = ReadPhotos(options.images.empty() ? usual : root / options.images, listener);
  if (scene.views.empty() && options.images.empty()) {
    scene.views = ReadPhotos(root, listener);
  } else if (const std::string poses = DescribeUnreadPoses(root); !poses.empty()) {
    listener(Note{fmt::format("{}: {}", OneLine(root.string()), poses)});
  }
  if (scene.views.empty()) {
    throw InputError(
        "{}: no scene found; expected a COLMAP model (sparse/0), transforms.json, transforms_train.json, or photos "
        "(JPEG, PNG, HEIC, AVIF, WebP, TIFF) here or in images/",
        (options.images.empty() ? root : root / options.images).string());
  }
  return scene;
}

}  // namespace

Scene ReadScene(const fs::path& folder, const SceneReadOptions& options, const Listener& listener) {
  const fs::path root = folder.has_filename() ? folder : folder.parent_path();  // "scene/" has another end
  RequireFolder(root, "name the folder that holds the scene");
  if (!options.images.empty())
    RequireFolder(root / options.images, "--images takes a folder, from the scene's or absolute");
  const bool has_transforms = IsFile(root / "transforms.json"), is_blender = IsFile(root / "transforms_train.json");
  auto model = FindModel(root, options, listener);
  if (model && (has_transforms || is_blender)) {
    listener(Note{fmt::format(
        "{}: the poses are those of the COLMAP model in {}; to use those of {}, copy it and the "
        "photos to a folder without the model",
        root.string(), model->model.string(), has_transforms ? "transforms.json" : "transforms_train.json")});
  }
  const auto* dataset = model || has_transforms || is_blender ? nullptr : FindDataset(root);
  if (!model && !has_transforms && !is_blender && dataset == nullptr) model = FindModelBeside(root, options, listener);
  Scene scene;
  if (model) {
    scene = ReadColmapScene(model->model, model->images, listener, options.allow_outside);
  } else if (has_transforms) {
    scene = ReadTransformsScene(root, options, listener);
  } else if (is_blender) {
    scene = ReadBlenderScene(root, options, listener);
  } else if (dataset != nullptr) {
    scene = dataset->read(root, options, listener);
  } else {
    scene = ReadPhotoFolder(root, options, listener);
  }
  if (scene.HasPoses()) RequireInside(scene, root, options);
  scene.root = root;
  if (scene.HasPoses()) FitCamerasToImages(&scene, listener);
  RequireUtf8Names(scene);
  const Listener of_masks = options.other_masks ? Silent() : listener;
  for (const char* folder : {"masks", "mask"}) AttachMasks(root / folder, of_masks, &scene);
  if (options.other_masks) {
    DropMasks(&scene, listener);
  } else {
    CheckMasks(&scene, listener);
  }
  if (!options.faces.empty()) {
    if (!scene.HasPoses()) MarkSpheres(options.spheres, &scene);
    TakeFaces(options.faces, listener, &scene);
  }
  RequireNoSpheres(scene);
  ReadPointFile(listener, &scene);
  return scene;
}

}  // namespace oraclegs
