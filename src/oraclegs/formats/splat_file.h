#pragma once
// Splat files of every format, distinguished by the end of their names.

#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/gaussians/ply.h"

namespace oraclegs {

enum class SplatFormat { kPly, kCompressedPly, kSplat, kSpz, kSog, kGltf, kGltfSpz };

/// By the end of the name: .ply .compressed.ply .splat .spz .sog .glb .spz.glb, in small or capital letters. Throws
/// UsageError for another one, naming those there are, or how to convert it.
SplatFormat SplatFormatOf(const std::filesystem::path& path);
/// True where SplatFormatOf finds a format.
bool HasSplatFormat(const std::filesystem::path& path);
/// The end of the name: ".spz".
const char* ExtensionOf(SplatFormat format);

/// True for a folder that is a splat: SOG whose files stand side by side.
bool IsSplatFolder(const std::filesystem::path& path);

/// Reads any of these; a PLY of either kind under both of their names, and a folder of SOG, named itself or by its
/// meta.json. What was left out or assumed becomes a Warning each. Throws InputError naming the file, UsageError for a
/// name as above.
GaussianPly ReadSplat(const std::filesystem::path& path, const Listener& listener = Silent());

/// Writes atomically, of the splat's degree (.splat: 0). Comments, support and the mark of antialiased training are
/// kept where the format can hold them. What is written was read back and lies within the errors of the format
/// (promise.h): up to one Gaussian in a thousand that does not is left out with a Warning, more are refused. Returns
/// how many Gaussians it has. Throws InputError, RunError, UsageError.
int64_t WriteSplat(const std::filesystem::path& path, const GaussianPly& splat, const Listener& listener = Silent());

}  // namespace oraclegs
