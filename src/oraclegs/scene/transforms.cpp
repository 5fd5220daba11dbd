#include "oraclegs/scene/transforms.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/scene/transforms_frame.h"
#include "oraclegs/scene/view_list.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Puts the words NaN, Infinity and -Infinity, which Python writes and JSON does not know, in quotes, so that the error
/// names the frame that has one and not only a byte.
std::string QuoteNaN(const std::string& text) {
  const auto word_at = [&](size_t i) -> std::string_view {
    for (const std::string_view word : {"NaN", "-Infinity", "Infinity"}) {
      if (text.compare(i, word.size(), word) == 0) return word;
    }
    return {};
  };
  std::string quoted;
  quoted.reserve(text.size());
  bool in_string = false;
  for (size_t i = 0; i < text.size();) {
    const std::string_view word = in_string ? std::string_view() : word_at(i);
    const bool escape = in_string && text[i] == '\\' && i + 1 < text.size();
    const size_t length = escape ? 2 : std::max<size_t>(word.size(), 1);
    if (text[i] == '"') in_string = !in_string;
    if (!word.empty()) quoted += '"';
    quoted.append(text, i, length);
    if (!word.empty()) quoted += '"';
    i += length;
  }
  return quoted;
}

json ParseJson(const fs::path& path) {
  try {
    return json::parse(QuoteNaN(ReadFile(path)));
  } catch (const json::exception& error) {
    throw InputError("{}: is not valid JSON: {}", path.string(), error.what());
  }
}

/// The image that file_path means: as written or with an extension appended; empty when there is none.
fs::path FindImage(const fs::path& folder, const std::string& written) {
  static constexpr const char* kExtensions[] = {"", ".png", ".jpg", ".jpeg", ".PNG", ".JPG", ".JPEG"};
  for (const char* extension : kExtensions) {
    const fs::path path = folder / (written + extension);
    if (IsFile(path)) return path;
  }
  return {};
}

/// The same below options.images, where the path's first folder may be left out.
fs::path FindImage(const fs::path& root, const SceneReadOptions& options, const std::string& written) {
  if (options.images.empty()) return FindImage(root, written);
  const fs::path folder = root / options.images;
  const fs::path whole = FindImage(folder, written);
  if (!whole.empty()) return whole;
  const std::string name = ViewName(written);
  const size_t slash = name.find('/');
  return slash == std::string::npos ? fs::path() : FindImage(folder, name.substr(slash + 1));
}

/// The views of one file, and the masks it names in vain.
struct FileViews {
  std::vector<SceneView> views;
  std::vector<std::string> missing_masks;
};

SceneView ReadView(const TransformsFrame& frame, const std::string& written, const fs::path& image_path) {
  SceneView view;
  view.image_path = image_path;
  const fs::path extension = image_path.extension();
  const bool appended = !image_path.empty() && image_path.filename() != fs::path(written).filename();
  view.name = ViewName(appended ? written + extension.string() : written);
  if (image_path.empty()) return view;  // left out: its lens and pose matter to nobody
  view.lens = ReadTransformsLens(frame, image_path);
  view.cam_from_world = ReadTransformsPose(frame);
  return view;
}

FileViews ReadFrames(const fs::path& path, const SceneReadOptions& options) {
  const fs::path root = path.parent_path();
  const json file = ParseJson(path);
  const auto frames = file.is_object() ? file.find("frames") : file.end();
  if (!file.is_object() || frames == file.end() || !frames->is_array() || frames->empty()) {
    throw InputError("{}: has no \"frames\"; expected the layout of instant-ngp, Nerfstudio or Blender", path.string());
  }
  FileViews result;
  int index = 0;
  for (const json& entry : *frames) {
    TransformsFrame frame{file, entry, fmt::format("{}: frame {}", path.string(), index++)};
    const auto written = entry.is_object() ? entry.find("file_path") : entry.end();
    if (!entry.is_object() || written == entry.end() || !written->is_string()) {
      throw InputError("{}: has no \"file_path\"", frame.place);
    }
    const std::string name = written->get<std::string>();
    if (ViewName(name).empty() || std::any_of(name.begin(), name.end(), [](unsigned char c) { return c < ' '; })) {
      throw InputError("{}: \"file_path\" is empty or has control characters", frame.place);
    }
    frame.place = fmt::format("{}: frame '{}'", path.string(), name);
    SceneView view = ReadView(frame, name, FindImage(root, options, name));
    if (const auto mask = entry.contains("mask_path") ? frame.FindText("mask_path") : std::nullopt) {
      if (IsFile(root / *mask)) {
        view.mask_path = root / *mask;
      } else {
        result.missing_masks.push_back(*mask);
      }
    }
    result.views.push_back(std::move(view));
  }
  return result;
}

std::vector<SceneView> ReadViews(const fs::path& path, const SceneReadOptions& options, const Listener& listener) {
  FileViews read = ReadFrames(path, options);
  if (!read.missing_masks.empty()) {
    listener(Warning{fmt::format("{}: {} mask files do not exist, those views use all pixels: {}", path.string(),
                                 read.missing_masks.size(), SomeNames(read.missing_masks))});
  }
  return std::move(read.views);
}

std::string SearchedFolder(const fs::path& root, const SceneReadOptions& options) {
  return (options.images.empty() ? root : root / options.images).string();
}

}  // namespace

Scene ReadTransformsScene(const fs::path& root, const SceneReadOptions& options, const Listener& listener) {
  const fs::path path = root / "transforms.json";
  Scene scene;
  scene.root = root;
  scene.format = SceneFormat::kTransforms;
  KeepViewsWithImages(ReadViews(path, options, listener), path.string(), SearchedFolder(root, options), listener,
                      &scene);
  return scene;
}

Scene ReadBlenderScene(const fs::path& root, const SceneReadOptions& options, const Listener& listener) {
  struct Part {
    const char* file;
    DeclaredRole role;
  };
  constexpr Part kParts[] = {{"transforms_train.json", DeclaredRole::kTrain},
                             {"transforms_test.json", DeclaredRole::kTest},
                             {"transforms_val.json", DeclaredRole::kVal}};
  std::vector<SceneView> views;
  std::set<std::string> names;
  for (const Part& part : kParts) {
    const fs::path path = root / part.file;
    if (part.role != DeclaredRole::kTrain && !IsFile(path)) {
      if (part.role == DeclaredRole::kTest) {
        listener(Warning{fmt::format("{}: has no transforms_test.json, so no view is held out", root.string())});
      }
      continue;
    }
    for (SceneView& view : ReadViews(path, options, listener)) {
      view.role = part.role;
      const bool is_new = names.insert(view.name).second;
      if (is_new || part.role != DeclaredRole::kVal) views.push_back(std::move(view));
    }
  }
  Scene scene;
  scene.root = root;
  scene.format = SceneFormat::kBlender;
  KeepViewsWithImages(std::move(views), root.string(), SearchedFolder(root, options), listener, &scene);
  return scene;
}

}  // namespace oraclegs
