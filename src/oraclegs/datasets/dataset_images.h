#pragma once
// The images of a dataset: those that lie in a folder, in the order of their names, and those that a file names.

#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// The folder of a dataset's images: options.images; else the first of `usual` below root; else images_N/ with the
/// smallest N; else root.
std::filesystem::path DatasetImageFolder(const std::filesystem::path& root, const SceneReadOptions& options,
                                         const std::vector<const char*>& usual = {"images"});

/// The images that lie in a folder itself, not hidden, sorted by the bytes of their names, as Python sorts them.
std::vector<std::filesystem::path> SortedImages(const std::filesystem::path& folder);

/// The views of images that rows of `source` stand for one by one, sorted by name; without cameras. Throws InputError
/// naming both when there are not as many images as rows. `row` is the word for one of them.
std::vector<SceneView> ViewsOfRows(const std::filesystem::path& folder, size_t rows, const std::string& source,
                                   const char* row);

/// The views of images that `source` names, in its order, also without extension; image_path is empty where there is
/// none. Without cameras. Throws InputError for what cannot be a name.
std::vector<SceneView> ViewsOfNames(const std::vector<std::string>& names, const std::string& source,
                                    const std::filesystem::path& folder, const SceneReadOptions& options,
                                    const Listener& listener);

/// A scene of these views, said in a note: "ROOT: a dataset of LLFF (poses_bounds.npy) with 20 views in images_8/".
/// Throws InputError as KeepViewsWithImages does.
Scene SceneOfDataset(const std::filesystem::path& source, SceneFormat format, std::vector<SceneView> views,
                     const std::filesystem::path& images, const Listener& listener);

}  // namespace oraclegs
