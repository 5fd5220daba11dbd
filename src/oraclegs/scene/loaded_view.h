#pragma once
// From files to pixels: read, undistort, downscale, composite.

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/core/options.h"
#include "oraclegs/camera/camera.h"
#include "oraclegs/image/image.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

struct ImageOptions {
  int downscale = 1;                 ///< whole factor
  std::string background = "black";  ///< what transparent pixels are composited on

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("downscale", self.downscale,
          "Divide the photographs' size by this (antialiased; an existing images_N folder is used)", Range{1, 64});
    visit("background", self.background, "Colour behind transparent pixels and behind the scene",
          Choice{{"black", "white", "grey"}});
  }
};

/// RGB in [0, 1] of ImageOptions::background.
std::array<float, 3> BackgroundColor(const std::string& name);

/// A photograph ready for use: pinhole, at working resolution.
struct LoadedView {
  std::string name;
  Camera camera;
  ImageF rgb;                     ///< 3 channels, composited on the background
  std::vector<uint8_t> mask;      ///< height * width, 1 = counts in losses and metrics; empty = all count
  std::vector<float> alpha = {};  ///< height * width, how much of the pixel the scene covers, of a Blender scene's
                                  ///< pictures with an alpha channel; empty = unknown
};

/// Loads the given views of a scene with poses, in their order, on all threads. Undistortion happens at full size, then
/// the area filter; sizes are round(size / downscale). The alpha channel composites onto the background; it masks
/// nothing (a Blender scene's background is part of what is scored, and its alpha is kept) unless the scene is a
/// photograph scene, where alpha < 0.5 excludes the pixel. A mask file excludes pixels below 128. A file images_N/NAME
/// beside images/NAME is read in the photograph's place when N = downscale and it has the working size.
/// FittingOrientation says whether a JPEG's EXIF orientation is applied. `listener` hears StepDone{"load"}, from any
/// thread but one at a time, and one warning that names the photographs of which no pixel counts. Throws InputError
/// naming the file: unreadable, or of another size than its lens says.
std::vector<LoadedView> LoadViews(const Scene& scene, const std::vector<int>& views, const ImageOptions& options,
                              const Listener& listener);

/// How a picture file shows what the view's lens saw, when that lens has this size: upright, or as stored when only
/// that has the size; for a view that is `as_stored` the other way round. Nothing when neither has it. Reads the
/// header.
std::optional<Orientation> FittingOrientation(const SceneView& view, const std::filesystem::path& file, int width,
                                              int height);

/// A side of LoadViews' pictures: round(size / downscale), at least 1.
int WorkingSize(int size, int downscale);

/// The file that LoadViews opens for the view: its photograph, or the one of images_N.
std::filesystem::path ImageFile(const SceneView& view, int downscale);

/// The camera that LoadViews gives the view, without reading pixels.
Camera WorkingCamera(const SceneView& view, const ImageOptions& options);

}  // namespace oraclegs
