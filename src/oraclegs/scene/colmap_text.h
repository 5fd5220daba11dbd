#pragma once
// COLMAP's .txt files. `file` names the source in error messages, which also give the line. All throw InputError.

#include <string>
#include <string_view>
#include <vector>

#include "oraclegs/scene/colmap_model.h"

namespace oraclegs {

/// cameras.txt: CAMERA_ID MODEL WIDTH HEIGHT PARAMS[], a line each.
ColmapCameras ParseCamerasText(std::string_view text, const std::string& file);

/// images.txt: IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME, each followed by a line of keypoints that may be empty.
std::vector<ColmapImage> ParseImagesText(std::string_view text, const std::string& file);

/// points3D.txt: POINT3D_ID X Y Z R G B ERROR, then the track as (IMAGE_ID, POINT2D_IDX).
std::vector<ColmapPoint> ParsePointsText(std::string_view text, const std::string& file);

}  // namespace oraclegs
