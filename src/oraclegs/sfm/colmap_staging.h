#pragma once
// The folder colmap reads: images linked, grouped by camera, with masks where pixels must not be used.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// Where one view stands below work_dir/images.
struct StagedView {
  std::string name;        ///< "camera0/0001.jpg", unique, without blanks; of a face: its sphere's
  int camera = 0;          ///< views with equal intrinsics share it; unknown ones: of one size, camera and focal length
  bool is_copy = false;    ///< a JPEG is written: colmap would see the image unturned, or reads no such file
  bool is_turned = false;  ///< the copy is turned by 90 degrees, clockwise: width and height are the camera's then
};

/// How photos of one device, some portrait and some landscape, are given to colmap, whose cameras have one size.
enum class Upright {
  kKeep,  ///< two sizes, two cameras
  kTurn,  ///< the fewer are turned, and all share one camera
};

/// One entry per element of `views`. Reads headers of the images, writes nothing. A photo that names no camera is
/// taken to be of the only one of its size that the others name.
/// Throws InputError for an image of unknown size that cannot be read.
std::vector<StagedView> PlanStaging(const Scene& scene, const std::vector<int>& views,
                                    Upright upright = Upright::kKeep);

/// Makes work_dir/images and work_dir/masks anew as planned; returns whether there are masks. Images are linked,
/// and copied only where that does not do. A mask (masks/NAME.png) joins the view's mask file and its alpha
/// channel: black where features must not be found.
/// Throws InputError for an image or mask that cannot be read, RunError when work_dir cannot be written.
bool StageImages(const Scene& scene, const std::vector<int>& views, const std::vector<StagedView>& plan,
                 const std::filesystem::path& work_dir);

/// All that a result depends on: each view's name, content of image and mask, intrinsics and pose. Throws InputError
/// for a file that cannot be read.
nlohmann::json DescribeInputs(const Scene& scene, const std::vector<int>& views);

}  // namespace oraclegs
