#pragma once
// Splat files of every format, distinguished by the end of their names.

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/formats/promise.h"
#include "oraclegs/gaussians/ply.h"

namespace oraclegs {

enum class FileOrder { kKept, kByPlace };  ///< order of a file's Gaussians: the model's, or neighbors together

/// A row of the list of splat formats: everything that is known of one.
struct SplatFormat {
  std::string extension;  ///< the end of the name: ".spz"
  SplatPromise promise;
  FileOrder order = FileOrder::kKept;
  unsigned half_turn = 0;  ///< axes of the file that are the program's with the other sign, added up (values.h)
  int max_sh_degree = kMaxShDegree;
  bool keeps_comments = false;
  bool keeps_antialiased = false;  ///< has a mark for models that were trained antialiased
  GaussianPly (*decode)(std::string_view bytes, const std::string& file);
  std::string (*encode)(const GaussianPly& splat);  ///< takes the program's axes, and no higher degree
};

/// All formats. Whoever reads, writes, turns or names splat files goes by these rows.
const std::vector<SplatFormat>& SplatFormats();

/// These formats, with .spz as version 4.
std::vector<SplatFormat> WithSpz4(std::vector<SplatFormat> formats);

/// The ends of their names: ".ply, .spz or .glb".
std::string SplatExtensions(const std::vector<SplatFormat>& formats = SplatFormats());

/// The format of a file by the end of its name, in small or capital letters. Throws UsageError for an unknown end,
/// naming those there are, or how to convert it.
const SplatFormat& SplatFormatOf(const std::filesystem::path& path,
                                 const std::vector<SplatFormat>& formats = SplatFormats());

/// True for a folder that is a splat: SOG whose files stand side by side.
bool IsSplatFolder(const std::filesystem::path& path);

/// The name of a splat file without the end that says its format; nullopt where the end says none, read or refused.
std::optional<std::string> SplatNameOf(const std::filesystem::path& path);

/// Reads any of these; a PLY of either kind under both of their names, and a folder of SOG, named itself or by its
/// meta.json. Everything left out or assumed becomes a Warning. Throws InputError naming the file, UsageError for a
/// name as above.
GaussianPly ReadSplat(const std::filesystem::path& path, const Listener& listener = Silent(),
                      const std::vector<SplatFormat>& formats = SplatFormats());

/// Writes atomically, of the splat's degree or the highest that the format has. Comments, support and the mark of
/// antialiased training are kept where the format can hold them. The file was read back and lies within the errors of
/// the format (promise.h): up to one Gaussian in a thousand that does not is left out with a Warning, more are refused.
/// Returns how many Gaussians it has. Throws InputError, RunError, UsageError.
int64_t WriteSplat(const std::filesystem::path& path, const GaussianPly& splat, const Listener& listener = Silent(),
                   const std::vector<SplatFormat>& formats = SplatFormats());

}  // namespace oraclegs
