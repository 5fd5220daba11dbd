#include "oraclegs/scene/transforms.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "oraclegs/core/error.h"
#include "oraclegs/core/text.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/scene/declared_split.h"
#include "oraclegs/scene/named_files.h"
#include "oraclegs/scene/scene.h"
#include "oraclegs/scene/transforms_frame.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr size_t kBlenderParts = 2;       // train/r_0 and test/r_0 are two views
constexpr double kUnseenRounding = 2e-5;  // between five decimals and four

/// The image of a frame, below options.images when that is given, where the path's first folder may be left out.
fs::path FindImage(const fs::path& root, const SceneReadOptions& options, const std::string& written) {
  if (options.images.empty()) return FindFrameImage(root, written);
  const fs::path folder = root / options.images;
  fs::path whole = FindFrameImage(folder, written);
  if (!whole.empty()) return whole;
  const std::string name = ViewName(written);
  const size_t slash = name.find('/');
  return slash == std::string::npos ? fs::path() : FindFrameImage(folder, name.substr(slash + 1));
}

/// One file's frames with their images, and the masks it names that do not exist.
struct FileViews {
  std::vector<SceneView> views;
  std::vector<std::string> missing_masks;
  fs::path point_file;
  std::vector<double> roundings;  ///< roundings by ReadTransformsPose, of each view with an image
};

SceneView MakeView(const TransformsFrame& frame, const std::string& written, const NamedFile& image,
                   std::vector<double>* roundings) {
  SceneView view;
  view.image_path = image.path;
  const fs::path extension = image.path.extension();
  const bool appended = !image.path.empty() && image.path.filename() != fs::path(written).filename();
  view.name =
      !image.name.empty() ? image.name : ViewName(WithSlashes(appended ? written + extension.string() : written));
  if (image.path.empty()) return view;  // left out, so its camera is not read
  view.is_sphere = IsSphereFrame(frame);
  if (view.is_sphere) {
    ReadImageSize(image.path, &view.intrinsics.width, &view.intrinsics.height);
  } else {
    view.intrinsics = ReadTransformsIntrinsics(frame, image.path);
  }
  const TransformsPose pose = ReadTransformsPose(frame);
  view.cam_from_world = pose.cam_from_world;
  roundings->push_back(pose.rounding);
  return view;
}

/// Files that frames name, and the views that they are of.
struct FrameFiles {
  NamedFilesQuery query;
  std::vector<size_t> views = {};

  void Add(const std::string& written, size_t view) {
    query.written.push_back(written);
    views.push_back(view);
  }
};

/// Those that exist become a member of their views; the others go to `missing`.
void SetFiles(const FrameFiles& named, fs::path SceneView::*member, std::vector<std::string>* missing,
              FileViews* result, const Listener& listener) {
  const std::vector<NamedFile> files = FindNamedFiles(named.query, listener);
  for (size_t i = 0; i < files.size(); ++i) {
    result->views[named.views[i]].*member = files[i].path;
    if (files[i].path.empty()) missing->push_back(named.query.written[i]);
  }
}

constexpr double kMillimeter = 1e-3;  // of a scene in meters: the depth unit where the file has none

/// Scene units of a level of a frame's depth, by the key of Nerfstudio or of instant-ngp.
double DepthUnitOf(const TransformsFrame& frame) {
  for (const char* key : {"depth_unit_scale_factor", "integer_depth_scale"}) {
    const auto unit = frame.FindNumber(key);
    if (!unit) continue;
    if (*unit > 0) return *unit;
    throw InputError("{}: \"{}\" is {}; give the scene units of a level of the depth files, 0.001 for millimeters",
                     frame.place, key, *unit);
  }
  return kMillimeter;
}

/// The frames' depth of a sensor, and its confidence, without which depth that has one is not to be trusted.
void AddSensorFiles(const fs::path& path, const std::vector<NamedTransformsFrame>& frames, const NamedFilesQuery& empty,
                    FileViews* result, const Listener& listener) {
  FrameFiles depths{empty, {}}, confidences{empty, {}};
  std::vector<std::string> unread, missing;
  for (size_t i = 0; i < frames.size(); ++i) {
    const TransformsFrame& frame = frames[i].frame;
    const bool is_left_out = result->views[i].image_path.empty();
    if (is_left_out || !frame.frame.contains("depth_file_path")) continue;
    const std::string written = frame.FindText("depth_file_path").value_or("");
    const fs::path extension = fs::path(written).extension();
    if (extension != ".png" && extension != ".PNG") {
      unread.push_back(written);
      continue;
    }
    depths.Add(written, i);
    result->views[i].depth_unit = DepthUnitOf(frame);
    if (frame.frame.contains("confidence_file_path")) {
      confidences.Add(frame.FindText("confidence_file_path").value_or(""), i);
    }
  }
  SetFiles(depths, &SceneView::depth_path, &missing, result, listener);
  SetFiles(confidences, &SceneView::confidence_path, &missing, result, listener);
  for (const size_t i : confidences.views) {
    SceneView& view = result->views[i];
    if (view.depth_path.empty() || view.confidence_path.empty()) view.depth_path = view.confidence_path = fs::path();
  }
  if (!unread.empty()) {
    listener(Note{fmt::format("{}: names depth that is no PNG and is not read: {}; write PNGs of 16 bits to use it",
                              path.string(), OneLine(SomeNames(unread)))});
  }
  if (!missing.empty()) {
    listener(
        Warning{fmt::format("{}: {} of depth or its confidence do not exist, and the photos that name them have "
                            "no depth of a sensor: {}",
                            path.string(), Counted(missing.size(), "file"), OneLine(SomeNames(missing)))});
  }
}

/// The start cloud that the file names, in the coordinates of its cameras; empty without.
fs::path PointFileOf(const fs::path& path, const json& file, const Listener& listener) {
  const auto written = TransformsFrame{file, file, path.string()}.FindText("ply_file_path");
  if (!written) return {};
  fs::path points = path.parent_path() / WithSlashes(*written);
  if (IsFile(points)) return points;
  listener(Warning{fmt::format("{}: names points ({}) that do not exist; they are triangulated anew", path.string(),
                               OneLine(*written))});
  return {};
}

/// `min_parts`: as of NamedFilesQuery, for the images.
FileViews ReadFrames(const fs::path& path, size_t min_parts, const SceneReadOptions& options,
                     const Listener& listener) {
  const fs::path root = path.parent_path();
  const json file = ReadTransformsFile(path);
  std::vector<NamedTransformsFrame> frames;
  for (const json& entry : file["frames"]) {
    frames.push_back(NamedFrame(file, entry, path, static_cast<int>(frames.size())));
  }
  NamedFilesQuery images{path.string(),
                         options.images.empty() ? root : root / options.images,
                         {},
                         min_parts,
                         options.allow_outside,
                         false,
                         [&](const std::string& written) { return FindImage(root, options, written); }};
  for (const NamedTransformsFrame& frame : frames) images.written.push_back(frame.file_path);
  const std::vector<DeclaredRole> roles = RolesInTransforms(file, images.written, path.string(), listener);
  const std::vector<NamedFile> files = FindNamedFiles(images, listener);
  FileViews result;
  result.point_file = PointFileOf(path, file, listener);
  FrameFiles masks{{path.string(), root, {}, 2, options.allow_outside, true}};
  for (size_t i = 0; i < frames.size(); ++i) {
    const TransformsFrame& frame = frames[i].frame;
    result.views.push_back(MakeView(frame, frames[i].file_path, files[i], &result.roundings));
    result.views.back().role = roles[i];
    if (const auto mask = frame.frame.contains("mask_path") ? frame.FindText("mask_path") : std::nullopt) {
      masks.Add(*mask, i);
    }
  }
  SetFiles(masks, &SceneView::mask_path, &result.missing_masks, &result, listener);
  AddSensorFiles(path, frames, {path.string(), root, {}, 2, options.allow_outside, false}, &result, listener);
  return result;
}

/// Rotations of few decimals are a little off, which is said.
void ReportRounding(const fs::path& path, const std::vector<double>& roundings, const Listener& listener) {
  const auto count = std::count_if(roundings.begin(), roundings.end(), [](double r) { return r > kUnseenRounding; });
  if (count == 0) return;
  listener(Note{fmt::format("{}: {} of {} are off by up to {:.2g}, as by few decimals; the nearest rotations are used",
                            path.string(), count, Counted(roundings.size(), "rotation"),
                            *std::max_element(roundings.begin(), roundings.end()))});
}

FileViews ReadViews(const fs::path& path, size_t min_parts, const SceneReadOptions& options, const Listener& listener) {
  FileViews read = ReadFrames(path, min_parts, options, listener);
  ReportRounding(path, read.roundings, listener);
  if (!read.missing_masks.empty()) {
    listener(Warning{fmt::format("{}: {} mask files do not exist, those views use all pixels: {}", path.string(),
                                 read.missing_masks.size(), SomeNames(read.missing_masks))});
  }
  return read;
}

std::string SearchedFolder(const fs::path& root, const SceneReadOptions& options) {
  return (options.images.empty() ? root : root / options.images).string();
}

}  // namespace

Scene ReadTransformsScene(const fs::path& root, const SceneReadOptions& options, const Listener& listener) {
  const fs::path path = root / "transforms.json";
  Scene scene;
  scene.root = root;
  scene.format = SceneFormat::kTransforms;
  FileViews read = ReadViews(path, 1, options, listener);
  KeepViewsWithImages(std::move(read.views), path.string(), SearchedFolder(root, options), listener, &scene);
  scene.point_file = std::move(read.point_file);
  ReportDeclaredSplit(scene, path.string(), listener);
  return scene;
}

Scene ReadBlenderScene(const fs::path& root, const SceneReadOptions& options, const Listener& listener) {
  struct SplitFile {
    const char* file;
    DeclaredRole role;
  };
  constexpr SplitFile kSplitFiles[] = {{"transforms_train.json", DeclaredRole::kTrain},
                                       {"transforms_test.json", DeclaredRole::kTest},
                                       {"transforms_val.json", DeclaredRole::kVal}};
  std::vector<SceneView> views;
  std::set<std::string> names;
  for (const SplitFile& split : kSplitFiles) {
    const fs::path path = root / split.file;
    if (split.role != DeclaredRole::kTrain && !IsFile(path)) {
      if (split.role == DeclaredRole::kTest) {
        listener(Warning{fmt::format("{}: has no transforms_test.json, so no view is held out", root.string())});
      }
      continue;
    }
    for (SceneView& view : ReadViews(path, kBlenderParts, options, listener).views) {
      view.role = split.role;
      const bool is_new = names.insert(view.name).second;
      if (is_new || split.role != DeclaredRole::kVal) views.push_back(std::move(view));
    }
  }
  Scene scene;
  scene.root = root;
  scene.format = SceneFormat::kBlender;
  KeepViewsWithImages(std::move(views), root.string(), SearchedFolder(root, options), listener, &scene);
  return scene;
}

}  // namespace oraclegs
