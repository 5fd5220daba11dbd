#pragma once
// Renders images and a video along a camera path.

#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/core/options.h"
#include "oraclegs/core/progress.h"
#include "oraclegs/scene/frame.h"
#include "oraclegs/stages/evaluate_stage.h"

namespace oraclegs {

/// Choice of the cameras to render.
enum class PathKind { kTrain, kTest, kOrbit, kSpiral, kInterpolate };
template <>
struct EnumWords<PathKind> {
  static constexpr EnumWord<PathKind> kWords[] = {{PathKind::kTrain, "train"},
                                                  {PathKind::kTest, "test"},
                                                  {PathKind::kOrbit, "orbit"},
                                                  {PathKind::kSpiral, "spiral"},
                                                  {PathKind::kInterpolate, "interpolate"}};
};

struct RenderPathOptions {
  PathKind path = PathKind::kOrbit;
  std::string what = "color";
  int frames = 120;
  int fps = 30;
  bool video = true;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("path", self.path,
          "Cameras to render: the training views, the test views, a flight among the training views, two rising turns, "
          "or smoothly through the training views in their order");
    visit("what", self.what,
          "What to render, separated by commas: color, depth (near is yellow), normals (camera frame), support (how "
          "well each Gaussian is supported by images), uncertainty (the error to expect, yellow is large)");
    visit("frames", self.frames, "Images of orbit, spiral and interpolate", Range{1, 1e5});
    visit("fps", self.fps, "Images per second of the video", Range{1, 240});
    visit("video", self.video, "Also write video.mp4 among the images, when ffmpeg is installed");
  }
};

struct NamedCamera {
  std::string name;  ///< name of the image file, without extension
  Camera camera;
};

/// Cameras of a path through a scene.
std::vector<NamedCamera> PathCameras(const PosedScene& posed, const ImageOptions& image,
                                     const RenderPathOptions& options);

/// Writes out/NAME.png for each camera and, when asked for and ffmpeg is installed, out/video.mp4; values other than
/// color go into folders of their own, e.g. out/depth/NAME.png. Returns the paths of the videos written; a video that
/// fails is a warning. Throws UsageError for an unknown value, InputError for a value that the model does not have,
/// RunError when the folder cannot be written.
std::vector<std::filesystem::path> RenderCameras(const Model& model, const std::vector<NamedCamera>& cameras,
                                                 const std::filesystem::path& out, const RenderPathOptions& options,
                                                 const Listener& listener);

}  // namespace oraclegs
