#pragma once
// From files to pixels: read, undistort, downscale, composite.

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/camera/camera.h"
#include "oraclegs/core/enum_words.h"
#include "oraclegs/core/progress.h"
#include "oraclegs/image/image.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// Color behind transparent pixels and behind the scene.
enum class Background { kBlack, kWhite, kGray };
template <>
struct EnumWords<Background> {
  static constexpr EnumWord<Background> kWords[] = {
      {Background::kBlack, "black"}, {Background::kWhite, "white"}, {Background::kGray, "gray"}};
};
/// Its RGB in [0, 1].
std::array<float, 3> BackgroundColor(Background background);

/// Files that --downscale N reads.
enum class SmallerCopies {
  kWhereFound,  ///< the files of images_N, else the images, resized
  kRequired,    ///< the files of images_N
};
template <>
struct EnumWords<SmallerCopies> {
  static constexpr EnumWord<SmallerCopies> kWords[] = {{SmallerCopies::kWhereFound, "auto"},
                                                       {SmallerCopies::kRequired, "required"}};
};

/// Filter that reduces the photos.
enum class ResizeFilter {
  kArea,    ///< area average, of floats
  kPillow,  ///< Pillow's bicubic filter, of bytes: what the programs of other papers train and score with
};
template <>
struct EnumWords<ResizeFilter> {
  static constexpr EnumWord<ResizeFilter> kWords[] = {{ResizeFilter::kArea, "area"}, {ResizeFilter::kPillow, "pillow"}};
};

/// Size and looks of loaded images.
struct ImageOptions {
  int downscale = 1;  ///< whole factor
  int max_size = 0;   ///< pixels of the longer side; 0 = no limit
  SmallerCopies smaller_copies = SmallerCopies::kWhereFound;
  ResizeFilter resize = ResizeFilter::kArea;
  Background background = Background::kBlack;
};

/// A view ready for use: pinhole, at working resolution.
struct LoadedView {
  std::string name;
  Camera camera;
  ImageF rgb;                       ///< 3 channels, composited on the background
  std::vector<uint8_t> mask;        ///< height * width, 1 = used in losses and metrics; empty = all are
  std::vector<float> weights = {};  ///< height * width in [0, 1], 0 where the mask is 0: how much of a used pixel the
                                    ///< alpha channel of a photo covers; empty = all of each
  std::vector<float> alpha = {};    ///< height * width, how much of the pixel the scene covers, of a Blender scene's
                                    ///< images with an alpha channel; empty = unknown
};

/// Loads the given views of a scene with poses, in their order, on all threads. Undistortion happens at full size, then
/// the filter; WorkingSize has the sizes. The alpha channel of a Blender scene composites onto the background,
/// which is part of what is scored, and is kept. In a scene of photos it is a mask: colors stay as they are stored
/// (straight), alpha < 0.5 excludes the pixel, and more weighs it. A mask file excludes pixels below half of white. A
/// file images_N/NAME beside images/NAME is read in its place when N = downscale and it has the working size.
/// FittingOrientation says whether a JPEG's EXIF orientation is applied. Reports StepDone{"load"} to `listener`, from
/// any thread but one at a time, and one warning that names the views whose masks exclude every pixel. Throws
/// InputError naming the file: unreadable, or of another size than the view's intrinsics.
std::vector<LoadedView> LoadViews(const Scene& scene, const std::vector<int>& views, const ImageOptions& options,
                                  const Listener& listener);

/// The orientation in which an image file has this size, that of the view's intrinsics: upright, or as stored when only
/// that has the size; for a view that is `as_stored` the other way round. Nothing when neither has it. Reads the
/// header.
std::optional<Orientation> FittingOrientation(const SceneView& view, const std::filesystem::path& file, int width,
                                              int height);

struct PixelSize {
  int width = 0, height = 0;
  bool operator==(const PixelSize&) const = default;
};

/// The size of LoadViews' image of an image of `full` pixels: round(side / downscale), then reduced in proportion
/// where the longer side exceeds --max-size; at least 1.
PixelSize WorkingSize(PixelSize full, const ImageOptions& options);

/// The file that LoadViews opens for the view: its image, or the one of images_N.
std::filesystem::path ImageFile(const SceneView& view, const ImageOptions& options);

/// The camera that LoadViews gives the view, without reading pixels.
Camera WorkingCamera(const SceneView& view, const ImageOptions& options);
/// The cameras that LoadViews gives the scene's views with these indices.
std::vector<Camera> WorkingCameras(const Scene& scene, const std::vector<int>& views, const ImageOptions& options);

/// The cameras of these views.
std::vector<Camera> CamerasOf(const std::vector<LoadedView>& views);

}  // namespace oraclegs
