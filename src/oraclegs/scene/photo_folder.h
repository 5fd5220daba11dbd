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

/// The photos below `dir`, by path and known by content. Hidden files and folders, workspaces of oraclegs, folders and
/// files of masks, depth maps and the like are passed over (photo_kind.h); of a folder that a known program wrote, its
/// photos alone are taken (capture_layout.h). Links to folders are followed, each folder is visited once, and none that
/// holds `dir`. Where there are no other images, those of one folder of depth maps or the like are the photos; not
/// those of masks/. Files that are passed over though they look like photos, files that are taken though they do not,
/// and poses that are not read are named to `listener`, once for each reason.
std::vector<std::filesystem::path> FindPhotos(const std::filesystem::path& dir, const Listener& listener);

/// The photos below `dir` as views: named by their path below it, with the size of each and what EXIF says of its
/// camera. Empty when there are none. A photo that cannot be read is left out and named to `listener` when three others
/// can be. Throws InputError for such a photo otherwise, and for more than kMaxPhotos.
std::vector<SceneView> ReadPhotos(const std::filesystem::path& dir, const Listener& listener);

}  // namespace oraclegs
