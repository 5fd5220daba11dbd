#pragma once
// COLMAP's .bin files, little endian. `file` names the source in error messages; every count is checked against the
// bytes that are left before memory is reserved. All throw InputError.

#include <string>
#include <string_view>
#include <vector>

#include "oraclegs/scene/colmap_model.h"

namespace oraclegs {

/// cameras.bin: count, then id u32, model i32, width u64, height u64, parameters f64.
ColmapCameras ParseCamerasBinary(std::string_view bytes, const std::string& file);

/// images.bin: count, then id u32, quaternion wxyz and translation 7 f64, camera u32, name up to a zero byte,
/// keypoints.
std::vector<ColmapImage> ParseImagesBinary(std::string_view bytes, const std::string& file);

/// points3D.bin: count, then id u64, xyz 3 f64, rgb 3 u8, error f64, track length u64, track of (image, keypoint) u32.
std::vector<ColmapPoint> ParsePointsBinary(std::string_view bytes, const std::string& file);

}  // namespace oraclegs
