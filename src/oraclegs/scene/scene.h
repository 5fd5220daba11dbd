#pragma once
// A scene before any pixel is read: views, points, and what every reader does with the views it found.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/camera/fisheye_lens.h"
#include "oraclegs/camera/intrinsics.h"
#include "oraclegs/core/enum_words.h"
#include "oraclegs/core/progress.h"
#include "oraclegs/image/exif.h"

namespace oraclegs {

/// The format a scene was read from. The values stand in keys of runs.
enum class SceneFormat {
  kColmap = 0,
  kTransforms = 1,
  kBlender = 2,
  kPhotos = 3,
  kLlff = 4,
  kNeus = 5,
  kBundler = 6,
  kMetashape = 7,
  kRealityScan = 8,
  kPolycam = 9,
  kRecord3d = 10,
};

/// Words for people: "COLMAP model", "photos without poses".
const char* SceneFormatName(SceneFormat format);

/// Which file of a Blender-style scene a view came from, or which list of a transforms.json names it; else kNone.
enum class DeclaredRole { kNone, kTrain, kVal, kTest };

/// The photo of what is all around it, spherical or fisheye, that a view is a face of (scene/spheres.h).
struct SphereSource {
  std::string name;  ///< the photo's own, as a view's
  std::filesystem::path image_path, mask_path;
  uint8_t mask_white = 255;
  int face = 0;                     ///< index into SphereFaces()
  std::optional<FisheyeLens> lens;  ///< without one it is equirectangular
  bool as_stored = false;           ///< SceneView::as_stored
};

/// Which photos without poses are spheres.
enum class SphereChoice {
  kMarked,  ///< those whose metadata says so
  kAll,     ///< all that are twice as wide as high
};
template <>
struct EnumWords<SphereChoice> {
  static constexpr EnumWord<SphereChoice> kWords[] = {{SphereChoice::kMarked, "marked"}, {SphereChoice::kAll, "all"}};
};

/// An image with its camera: intrinsics and, unless the scene is a plain folder, a pose.
struct SceneView {
  std::string name;                  ///< unique; the image's path below the image folder, e.g. "0001.jpg"
  std::filesystem::path image_path;  ///< exists
  std::filesystem::path mask_path;   ///< empty when there is none; white = use, black = ignore
  uint8_t mask_white = 255;          ///< the mask file's value for white; from half of it on, pixels are used
  Intrinsics intrinsics;             ///< intrinsics of the full-size image; params empty for a plain folder
  std::optional<Eigen::Isometry3d> cam_from_world;
  std::string camera;              ///< maker and model, from the EXIF of a plain folder; may be empty
  double focal_prior = 0;          ///< focal length in pixels, from the EXIF of a plain folder; 0 = unknown
  std::optional<GpsPosition> gps;  ///< position from the EXIF of a plain folder
  bool as_stored = false;          ///< the camera describes the pixels as stored: the EXIF orientation is ignored
  DeclaredRole role = DeclaredRole::kNone;
  bool is_sphere = false;  ///< no pinhole camera's image, but an equirectangular one: not yet cut
  std::optional<SphereSource> sphere;
  std::filesystem::path depth_path = {};       ///< depth of a sensor (sensor_files.h); empty when there is none
  std::filesystem::path confidence_path = {};  ///< of that depth; empty when there is none
  double depth_unit = 1e-3;                    ///< scene units of a level of the depth file
};

struct ScenePoint {
  Eigen::Vector3d xyz;
  std::array<uint8_t, 3> rgb{128, 128, 128};
  std::vector<int> views;  ///< indices into Scene::views of the views that saw it, ascending
};

/// A scene as read, views sorted by name.
struct Scene {
  std::filesystem::path root;
  SceneFormat format = SceneFormat::kPhotos;
  std::vector<SceneView> views;
  std::vector<ScenePoint> points;
  std::filesystem::path point_file;  ///< a PLY of points without tracks that the scene's files name, not yet read
  std::vector<std::string> missing_images;  ///< posed in the scene's files, but without an image file; left out

  bool HasPoses() const { return format != SceneFormat::kPhotos; }
};

struct SceneReadOptions {
  std::filesystem::path images = {};  ///< image folder, empty = where the format usually has it
  /// Also read what the scene's files name outside its folder and `images`. A stranger's scene could name any picture
  /// of this machine, which would then be in the result.
  bool allow_outside = false;
  /// Where the views are written that spherical and wide fisheye photos are cut into, by whoever uses them; empty =
  /// such photos with poses are refused, and those without stay photos.
  std::filesystem::path faces = {};
  SphereChoice spheres = SphereChoice::kMarked;
  bool other_masks = false;  ///< the run gets masks from elsewhere: those of the scene are left out, with a note
};

inline constexpr int kMaxImageSide = 1 << 20;  ///< pixels; more in a scene file is a damaged or mistaken number

/// Indices of all views, in order.
std::vector<int> AllViews(const Scene& scene);

/// Names of the views with these indices, in their order.
std::vector<std::string> NamesAt(const Scene& scene, const std::vector<int>& views);

/// True for a regular file; false, not an exception, for a path that cannot be looked at.
bool IsFile(const std::filesystem::path& path);

/// An image's path as written in a scene file, as a view's name: "./", "../" and a leading "/" are dropped, so that
/// a file named after the view stays inside the folder it is written to.
std::string ViewName(const std::string& written_path);

/// File name of a view without folder and extension: "left/0001.jpg" becomes "left_0001".
std::string FileName(const std::string& view);

/// File names of the views; a repeated name gets a number ("left_0001_2"), so that all differ.
std::vector<std::string> FileNames(const std::vector<std::string>& views);

/// Throws InputError naming the first image of the scene, missing ones included, whose name is not UTF-8: split,
/// scores and settings are JSON, which holds nothing else.
void RequireUtf8Names(const Scene& scene);

/// Moves `candidates` to scene->views, sorted by name (NaturalLess); those whose image_path is empty go to
/// scene->missing_images, with one warning to `listener`. `source` names the file that lists the views, `searched`
/// says where images were looked for. Throws InputError when two views have one name, or no view has an image.
void KeepViewsWithImages(std::vector<SceneView> candidates, const std::string& source, const std::string& searched,
                         const Listener& listener, Scene* scene);

/// Gives each view without a mask the file NAME, NAME.png or STEM.png below `mask_dir`, or the one that differs from
/// these in case, Unicode form or extension; a leading "images/" of the name may be left out. Does nothing when
/// mask_dir is not a folder; warns when it is and fits no view.
void AttachMasks(const std::filesystem::path& mask_dir, const Listener& listener, Scene* scene);

/// Writes positions and colors as an ascii PLY, as Nerfstudio and every viewer of point clouds read it, atomically.
/// Throws RunError.
void WritePointPly(const std::filesystem::path& path, const std::vector<ScenePoint>& points);

}  // namespace oraclegs
