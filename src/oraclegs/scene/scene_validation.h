#pragma once
// What every scene reader does with the views it found.

#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

inline constexpr int kMaxImageSide = 1 << 20;  // pixels; more in a scene file is a damaged or mistaken number

/// True for a regular file; false, not an exception, for a path that cannot be looked at.
bool IsFile(const std::filesystem::path& path);

/// A photograph's path as written in a scene file, as a view's name: "./", "../" and a leading "/" are dropped, so that
/// a file named after the view stays inside the folder it is written to.
std::string ViewName(const std::string& written_path);

/// "a, b, c, d, e and 7 more": at most five of `names`.
std::string SomeNames(const std::vector<std::string>& names);

/// True when `text` can stand in JSON as it is.
bool IsUtf8(const std::string& text);

/// Bytes outside ASCII as \xNN, to show a name that is not UTF-8.
std::string EscapeBytes(const std::string& text);

/// Throws InputError naming the first photograph of the scene, missing ones included, whose name is not UTF-8: split,
/// scores and settings are JSON, which holds nothing else.
void RequireUtf8Names(const Scene& scene);

/// Moves `candidates` to scene->views, sorted by name in byte order; those whose image_path is empty go to
/// scene->missing_images and one warning tells `listener`. `source` names the file that lists the views, `searched`
/// says where images were looked for. Throws InputError when two views have one name, or no view has an image.
void KeepViewsWithImages(std::vector<SceneView> candidates, const std::string& source, const std::string& searched,
                         const Listener& listener, Scene* scene);

/// Gives each view without a mask the file masks/NAME, masks/NAME.png or masks/STEM.png below `mask_dir`, if there is
/// one; a leading "images/" of the name may be left out. Does nothing when mask_dir is not a folder; warns when it is
/// and fits no view.
void AttachMasks(const std::filesystem::path& mask_dir, const Listener& listener, Scene* scene);

}  // namespace oraclegs
