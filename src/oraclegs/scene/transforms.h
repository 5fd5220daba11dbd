#pragma once
// Scenes described by JSON: transforms.json (instant-ngp, Nerfstudio) and Blender's transforms_{train,val,test}.json.
// Their cameras look along -z with y up (OpenGL); here they become x right, y down, z forward.

#include <filesystem>

#include "oraclegs/core/progress.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// Reads root/transforms.json. Intrinsics stand in the frame or else at the top of the file: fl_x fl_y (or
/// camera_angle_x camera_angle_y, radians), cx cy (default: the center), w h (default: the image file's size), k1 k2 k3
/// k4 p1 p2 with camera_model PINHOLE, SIMPLE_PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV or OPENCV_FISHEYE; with
/// EQUIRECTANGULAR the view is_sphere and has a size alone. The image is file_path as written, or with .png .jpg .jpeg
/// appended, below root (below options.images when that is given). A view's name is file_path with the extension found.
/// Throws InputError naming the file and the frame.
Scene ReadTransformsScene(const std::filesystem::path& root, const SceneReadOptions& options, const Listener& listener);

/// Reads root/transforms_train.json, transforms_test.json and transforms_val.json (the last two are optional) in the
/// same way; each view remembers which file it came from. A view of the val file that another file has too is dropped.
Scene ReadBlenderScene(const std::filesystem::path& root, const SceneReadOptions& options, const Listener& listener);

}  // namespace oraclegs
