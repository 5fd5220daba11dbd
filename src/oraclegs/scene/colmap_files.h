#pragma once
// COLMAP's .bin files, little endian, whose every count is checked against the bytes that are left before memory is
// reserved; and its .txt files. `file` names the source in error messages, which also give the line of a text. All
// parsers throw InputError.

#include <filesystem>
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

/// cameras.txt: CAMERA_ID MODEL WIDTH HEIGHT PARAMS[], a line each.
ColmapCameras ParseCamerasText(std::string_view text, const std::string& file);

/// images.txt: IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME, each followed by a line of keypoints that may be empty.
std::vector<ColmapImage> ParseImagesText(std::string_view text, const std::string& file);

/// points3D.txt: POINT3D_ID X Y Z R G B ERROR, then the track as (IMAGE_ID, POINT2D_IDX).
std::vector<ColmapPoint> ParsePointsText(std::string_view text, const std::string& file);

/// Writes cameras.txt, images.txt and points3D.txt; the keypoints are where the points were seen. Without points it is
/// a model of known poses for `colmap point_triangulator`. Numbers read back to the same bits, poses to rounding.
/// Throws InputError for an image name with a space or line break, which COLMAP's text reader would cut short, and
/// RunError when writing fails.
void WriteColmapText(const std::filesystem::path& dir, const ColmapCameras& cameras,
                     const std::vector<ColmapImage>& images, const std::vector<ColmapTrack>& points = {});

}  // namespace oraclegs
