#pragma once
// Depth maps as plain files that other tools open, and as preview images.

#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/camera/similarity.h"
#include "oraclegs/depth/fusion.h"

namespace oraclegs {

/// Names of the views' files, without extension: "a/b.jpg" -> "a_b"; those that would collide ("a/b.jpg", "a_b.png")
/// get their number, too.
std::vector<std::string> DepthFileStems(const std::vector<std::string>& names);

/// Writes files for each map, with NAME by DepthFileStems:
///   dir/NAME.png             16-bit gray: inverse depth
///   dir/confidence/NAME.png  8-bit gray, 255 = certain
///   dir/normals/NAME.png     8-bit RGB, 255 * (n + 1) / 2, camera frame; 0 0 0 where unknown
///   dir/preview/NAME.png     depth in viridis (yellow near, purple far) beside confidence in plasma (yellow high,
///   purple low)
/// and dir/depth_params.json as the code of [Kerbl 2023] reads it: {"NAME": {"scale", "offset"}}, inverse depth = value
/// / 65535 * scale + offset. An empty map has a scale of 0 and no files. Maps with a network's depth also have
/// "monocular": true there. `unit`: length of a unit of the maps in units of the files. Returns the paths written,
/// relative to dir. Throws RunError.
std::vector<std::string> WriteDepthMaps(const std::filesystem::path& dir, const std::vector<DepthMap>& maps,
                                        double unit = 1);

/// Reads the maps of these views and cameras. `unit` is that of WriteDepthMaps. Throws InputError naming the file that
/// is missing, damaged or of another size.
std::vector<DepthMap> ReadDepthMaps(const std::filesystem::path& dir, const std::vector<std::string>& names,
                                    const std::vector<Camera>& cameras, double unit = 1);

/// Writes points, moved by `placement`, as binary PLY: x y z nx ny nz red green blue confidence views. `comments` are
/// lines of its header. Throws RunError.
void WriteDensePly(const std::filesystem::path& path, const std::vector<DensePoint>& points,
                   const Similarity& placement = {}, const std::vector<std::string>& comments = {});

}  // namespace oraclegs
