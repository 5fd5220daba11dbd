#include "oraclegs/datasets/dataset_images.h"

#include <algorithm>
#include <charconv>
#include <system_error>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/scene/named_files.h"
#include "oraclegs/scene/transforms_frame.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> DatasetEntries(const fs::path& dir) {
  std::vector<fs::path> entries;
  std::error_code error;
  for (fs::directory_iterator it(dir, error), end; !error && it != end; it.increment(error)) {
    if (!it->path().filename().string().starts_with(".")) entries.push_back(it->path());
  }
  if (error) throw InputError("{}: cannot be listed ({}); check its permissions", dir.string(), error.message());
  std::sort(entries.begin(), entries.end(),
            [](const fs::path& a, const fs::path& b) { return a.filename().native() < b.filename().native(); });
  return entries;
}

/// The N of a folder images_N; 0 for other names.
int CopyFactor(const std::string& name) {
  constexpr std::string_view kPrefix = "images_";
  int factor = 0;
  if (!name.starts_with(kPrefix)) return 0;
  const auto [end, error] = std::from_chars(name.data() + kPrefix.size(), name.data() + name.size(), factor);
  return error == std::errc() && end == name.data() + name.size() && factor > 0 ? factor : 0;
}

/// Names stand in messages and become those of files.
void RequireNames(const std::vector<std::string>& names, const std::string& source) {
  for (size_t i = 0; i < names.size(); ++i) {
    const std::string& name = names[i];
    if (ViewName(name).empty() || std::any_of(name.begin(), name.end(), [](unsigned char c) { return c < ' '; })) {
      throw InputError("{}: its photo {} has no name, or one with control characters", source, i + 1);
    }
  }
}

}  // namespace

fs::path DatasetImageFolder(const fs::path& root, const SceneReadOptions& options,
                            const std::vector<const char*>& usual) {
  if (!options.images.empty()) return root / options.images;
  for (const char* name : usual) {
    if (IsFolder(root / name)) return root / name;
  }
  int smallest = 0;
  fs::path found = root;
  for (const fs::path& entry : DatasetEntries(root)) {
    const int factor = CopyFactor(entry.filename().string());
    if (factor == 0 || (smallest > 0 && factor >= smallest) || !IsFolder(entry)) continue;
    smallest = factor;
    found = entry;
  }
  return found;
}

std::vector<fs::path> SortedImages(const fs::path& folder) {
  std::vector<fs::path> images = DatasetEntries(folder);
  std::erase_if(images, [](const fs::path& path) { return !HasImageExtension(path) || !IsFile(path); });
  return images;
}

std::vector<SceneView> ViewsOfRows(const fs::path& folder, size_t rows, const std::string& source, const char* row) {
  const std::vector<fs::path> images = SortedImages(folder);
  if (images.size() != rows) {
    throw InputError(
        "{}: has {}, and {} has {}; they go together in the order of the names, so bring back the images "
        "it was made with, or name their folder with --images",
        source, Counted(rows, row), folder.string(), Counted(images.size(), "image"));
  }
  std::vector<SceneView> views(rows);
  for (size_t i = 0; i < rows; ++i) {
    views[i].name = images[i].filename().string();
    views[i].image_path = images[i];
  }
  return views;
}

std::vector<SceneView> ViewsOfNames(const std::vector<std::string>& names, const std::string& source,
                                    const fs::path& folder, const SceneReadOptions& options, const Listener& listener) {
  RequireNames(names, source);
  const NamedFilesQuery query{source, folder, names, 1, options.allow_outside, false, [&](const std::string& written) {
                                return FindFrameImage(folder, written);
                              }};
  const std::vector<NamedFile> files = FindNamedFiles(query, listener);
  std::vector<SceneView> views(names.size());
  for (size_t i = 0; i < names.size(); ++i) {
    views[i].image_path = files[i].path;
    std::string written = WithSlashes(names[i]);
    const std::string extension = files[i].path.extension().string();
    if (!files[i].path.empty() && files[i].path.filename() != fs::path(written).filename()) written += extension;
    views[i].name = files[i].name.empty() ? ViewName(written) : files[i].name;
  }
  return views;
}

Scene SceneOfDataset(const fs::path& source, SceneFormat format, std::vector<SceneView> views, const fs::path& images,
                     const Listener& listener) {
  Scene scene;
  scene.root = source.parent_path();
  scene.format = format;
  KeepViewsWithImages(std::move(views), source.string(), images.string(), listener, &scene);
  listener(Note{fmt::format("{}: is read as {}: {} of {}", OneLine(source.string()), SceneFormatName(format),
                            Counted(scene.views.size(), "view"), OneLine(images.string()))});
  return scene;
}

}  // namespace oraclegs
