#pragma once
// Depth of the user's own in place of stereo's.

#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/depth/depth_map.h"

namespace oraclegs {

/// Files of a folder of depth for these views: dir/depth_params.json, dir/NAME.png, and dir/confidence/NAME.png where
/// it exists, with NAME the view's name without extension. Throws InputError naming the one that is missing.
std::vector<std::filesystem::path> GivenDepthFiles(const std::filesystem::path& dir,
                                                   const std::vector<std::string>& names);

/// Reads inverse depth as the code of [Kerbl 2023] does, of 16 bits, value / 65536 * scale + offset with the numbers of
/// depth_params.json; 0 = unknown. Maps and confidences (8 bits, 255 = certain; without them all that is known is
/// confident) may have any size; the nearest pixel is taken. Normals follow from neighboring depths. `unit`: length of
/// a unit of the cameras in units of the files. Throws InputError naming the file.
std::vector<DepthMap> ReadGivenDepth(const std::filesystem::path& dir, const std::vector<std::string>& names,
                                     const std::vector<Camera>& cameras, double unit);

}  // namespace oraclegs
