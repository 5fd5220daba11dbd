#pragma once
// How good a model is that colmap made: what attempts are compared by, and what is reported of each image.

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "oraclegs/scene/colmap_model.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// One image of a model.
struct RegisteredImage {
  int points = 0;  ///< that it saw
  /// Median over them of the widest angle between this view's ray and another's; 0 without points.
  double parallax_degrees = 0;
  double nearest_degrees = 0;  ///< likewise of the narrowest angle
};

struct ModelQuality {
  std::map<std::string, RegisteredImage> images;  ///< by name below the image folder
  int points = 0;
  double reprojection_error = 0;                ///< pixels, mean over points
  double parallax_degrees = 0;                  ///< median over points of the widest angle between two of its rays
  bool plausible_intrinsics = true;             ///< every focal length within kFocalRange of its image's longer side
  std::vector<std::string> implausible_images;  ///< whose camera is not: names, as in `images`

  int registered() const { return static_cast<int>(images.size()); }
};

/// Focal lengths of common cameras, in longer sides of the image (13 mm to 150 mm on 36 mm); outside it
/// colmap has explained wrong matches by a focal length.
inline constexpr double kFocalRange[] = {.35, 4.2};
inline constexpr double kMaxDistortion = .6;  ///< bound of the first radial coefficient, for the same reason

ModelQuality MeasureModel(const ColmapCameras& cameras, const std::vector<ColmapImage>& images,
                          const std::vector<ColmapPoint>& points);
/// Quality of the model in a folder. Throws InputError as ReadColmapScene does.
ModelQuality MeasureModel(const std::filesystem::path& model_dir);

/// Images that share what they see from further apart only are doubtful, degrees: right cameras of hard sets are up to
/// 49 degrees apart, wrong ones 58 to 78.
inline constexpr double kMaxDegreesOfSift = 55;

/// True when a model can be right: two images or more, plausible intrinsics, points enough to hold the poses, rays that
/// cross at an angle, and some image that is not far from all others (kMaxDegreesOfSift). A wrong one has few points
/// (colmap drops what does not fit).
bool IsSound(const ModelQuality& model);

/// Why a model is not sound, in a few words; "" for one that is, or that has no images.
std::string FlawOf(const ModelQuality& model);

/// True when a model would be plausible without the images of `implausible_images`: they are the fewer, and two or more
/// are left.
bool HasPlausiblePart(const ModelQuality& model);

/// True when an image hangs on few points, less than a third of the usual number, or shares what it sees from far away
/// only (kMaxDegreesOfSift): it may stand at a wrong place.
bool HasLooseView(const ModelQuality& model);

/// By view of a scene, the share of its pixels whose depth dense stereo finds and confirms.
using ConfirmedShares = std::function<std::vector<double>(const Scene& model)>;

/// Views with next to no confirmed depth where most views have much: they stand at a wrong place, or show another one.
std::vector<size_t> MisplacedViews(const std::vector<double>& confirmed_shares);

/// True when `a` is to be kept rather than `b`: a sound one before one that is not, then more images, then clearly
/// more points, then the smaller reprojection error.
bool IsBetter(const ModelQuality& a, const ModelQuality& b);

}  // namespace oraclegs
