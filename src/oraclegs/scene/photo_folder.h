#pragma once
// A folder of photos without poses: which of its files are photos, what is left out and why, and what is known of each
// photo's camera.

#include <filesystem>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

inline constexpr size_t kMinGoodPhotos = 3;  ///< with fewer, a photo that cannot be read is an error
inline constexpr int kMaxPhotos = 500;       ///< unposed photos of one scene: every pair of them is matched

/// The photos below `dir`, by path. Hidden files and folders, workspaces of oraclegs, masks/ and images_N/ are passed
/// over; links to folders are not followed. Files that look like photos or videos and are none that can be read are
/// named to `listener`, one warning for each reason.
std::vector<std::filesystem::path> FindPhotos(const std::filesystem::path& dir, const Listener& listener);

/// The photos below `dir` as views: named by their path below it, with the size of each and what EXIF says of its
/// camera. Empty when there are none. A photo that cannot be read is left out and named to `listener` when three others
/// can be. Throws InputError for such a photo otherwise, and for more than kMaxPhotos.
std::vector<SceneView> ReadPhotos(const std::filesystem::path& dir, const Listener& listener);

/// True for the name of a folder beside photos that holds none of them: masks/, and the smaller copies images_2/,
/// images_4/, ...
bool IsHelperFolder(const std::string& name);

/// Why a file that looks like a photo or video of another kind is not read, and what to do: "raw photos are not read;
/// export them as JPEG"; empty for all other files. By name.
std::string WhyNotRead(const std::filesystem::path& path);

}  // namespace oraclegs
