#pragma once
// SOG of PlayCanvas, version 2, in one file: a zip of WebP images, where each Gaussian is a pixel, and of meta.json.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "oraclegs/formats/values.h"

namespace oraclegs {

/// The bytes of a .sog file; the Gaussians keep their order, which should be spatial. Errors: positions half of 1/65535
/// of the scene's range in sign(x) ln(1 + |x|), opacity 1/510, quaternion 1/360 a component; log scales (within [-20,
/// 20]) and color (within [-8, 9]) are the nearest of 256 values made for the scene, the harmonics above degree 0 of
/// each Gaussian (within [-4, 4]) the nearest of at most 16 384 sets. Support, if given, is an image of its own, which
/// other readers do not look at.
std::string EncodeSog(const Gaussians& gaussians, int sh_degree, const std::vector<float>& support = {});

/// A .sog file of version 2 (sog.h). Throws InputError naming `file`: no zip, no meta.json or one of another
/// version, images that are missing, damaged, or of another size than the number of Gaussians asks for.
GaussianPly DecodeSog(std::string_view bytes, const std::string& file);

/// True for a folder with the files of such an archive side by side: meta.json and its images.
bool IsSogFolder(const std::filesystem::path& folder);
/// Reads it, with the same errors.
GaussianPly ReadSogFolder(const std::filesystem::path& folder);

}  // namespace oraclegs
