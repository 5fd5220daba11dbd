#pragma once
// Splat files of every format, distinguished by the end of their names.

#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/gaussians/ply.h"

namespace oraclegs {

enum class SplatFormat { kPly, kCompressedPly, kSplat, kSpz, kSog, kGltf, kGltfSpz };

/// By the end of the name: .ply .compressed.ply .splat .spz .sog .glb .spz.glb, in small or capital letters. Throws
/// UsageError for another one, naming those there are.
SplatFormat SplatFormatOf(const std::filesystem::path& path);
/// The same without an error.
bool HasSplatFormat(const std::filesystem::path& path);
/// The end of the name: ".spz".
const char* ExtensionOf(SplatFormat format);

/// Reads any of these; a PLY of either kind under both of their names. Throws InputError naming the file, UsageError
/// for a name as above.
GaussianPly ReadSplat(const std::filesystem::path& path);

/// Writes atomically, of SH degree `sh_degree` (0..3; .splat always 0). Comments and support are kept where the format
/// can hold them. Throws RunError, UsageError.
void WriteSplat(const std::filesystem::path& path, const Gaussians& gaussians, int sh_degree,
                const std::vector<std::string>& comments = {}, const std::vector<float>& support = {});

}  // namespace oraclegs
