#include "oraclegs/scene/view_list.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <unordered_map>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"
#include "oraclegs/core/unique_json.h"

namespace oraclegs {
namespace {

constexpr uint64_t kMaxListBytes = 1 << 20;

constexpr size_t kWays = 4;

/// One of the ways to call a view, of which the first is the most exact.
std::string CalledIn(size_t way, const std::string& name) {
  if (way == 0) return name;
  std::filesystem::path path(name);
  if (way == 1) return path.filename().string();
  return way == 2 ? path.replace_extension().string() : path.stem().string();
}

/// Views by what they are called: lists and scenes may both be long. Each way is indexed when it is first asked for,
/// since most lists have whole names.
class ViewsByName {
 public:
  explicit ViewsByName(const Scene& scene) : scene_(scene) {}

  /// The views that are called so in one of the ways (CalledIn); null where there is none.
  const std::vector<int>* Find(size_t way, const std::string& name) {
    auto& by_name = ways_[way];
    if (by_name.empty()) {
      by_name.reserve(scene_.views.size());
      for (const int i : AllViews(scene_)) {
        const SceneView& view = scene_.views[static_cast<size_t>(i)];
        by_name[CalledIn(way, view.name)].push_back(i);
        if (view.sphere && view.sphere->face == 0) by_name[CalledIn(way, view.sphere->name)].push_back(i);
      }
    }
    const auto found = by_name.find(name);
    return found == by_name.end() ? nullptr : &found->second;
  }

 private:
  const Scene& scene_;
  std::array<std::unordered_map<std::string, std::vector<int>>, kWays> ways_;
};

/// The number of ":7"; nothing when the item is no position.
std::optional<size_t> PositionOf(const std::string& item) {
  if (item.size() < 2 || item[0] != ':') return {};
  size_t position = 0;
  const char* const end = item.data() + item.size();
  const auto [stop, error] = std::from_chars(item.data() + 1, end, position);
  if (error != std::errc() || stop != end) return {};
  return position;
}

int FindView(const Scene& scene, ViewsByName* views, const std::string& option, const std::string& wanted) {
  if (const auto position = PositionOf(wanted)) {
    if (*position < scene.views.size()) return static_cast<int>(*position);
    throw InputError("{}: {} asks for view {}, but the {} views are :0 to :{}", scene.root.string(), option, wanted,
                     scene.views.size(), static_cast<int64_t>(scene.views.size()) - 1);
  }
  for (size_t way = 0; way < kWays; ++way) {
    const std::vector<int>* called_so = views->Find(way, wanted);
    if (!called_so) continue;
    if (called_so->size() == 1) return called_so->front();
    throw InputError("{}: '{}' in {} could be any of {}; give its full name", scene.root.string(), wanted, option,
                     SomeNames(NamesAt(scene, *called_so)));
  }
  const auto missing = std::find_if(scene.missing_images.begin(), scene.missing_images.end(), [&](const auto& name) {
    for (size_t way = 0; way < kWays; ++way) {
      if (CalledIn(way, name) == wanted) return true;
    }
    return false;
  });
  if (missing != scene.missing_images.end()) {
    throw InputError("{}: the view '{}' in {} has no image file", scene.root.string(), wanted, option);
  }
  throw InputError("{}: no view is called '{}', which {} names; there are {}", scene.root.string(), wanted, option,
                   SomeNames(NamesAt(scene, AllViews(scene))));
}

std::vector<std::string> NamesInJson(const std::string& text, const std::string& file, const std::string& role) {
  const nlohmann::json json = ParseUniqueJson(text, file, "list of views");
  const auto names = json.find(role);
  if (names == json.end() || !names->is_array() ||
      !std::all_of(names->begin(), names->end(), [](const nlohmann::json& name) { return name.is_string(); })) {
    throw InputError("{}: has no list \"{}\" of view names, as split.json of a run has", file, role);
  }
  return names->get<std::vector<std::string>>();
}

}  // namespace

std::vector<int> NamedViews(const Scene& scene, const std::string& option, const std::string& list) {
  ViewsByName views(scene);
  std::vector<int> named;
  for (const std::string& item : SplitTrimmed(list, ',')) named.push_back(FindView(scene, &views, option, item));
  std::sort(named.begin(), named.end());
  named.erase(std::unique(named.begin(), named.end()), named.end());
  return named;
}

std::string ExpandViewList(const std::string& list, const std::string& role) {
  if (!list.starts_with('@')) return list;
  const std::string file = list.substr(1);
  std::string text = ReadFile(file, kMaxListBytes);
  if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);  // a byte order mark
  if (!IsUtf8(text)) throw InputError("{}: is not UTF-8 text; a list has one view name a line", file);
  std::vector<std::string> names;
  const size_t first = text.find_first_not_of(" \t\r\n");
  if (first != std::string::npos && text[first] == '{') {
    names = NamesInJson(text, file, role);
  } else {
    names = SplitTrimmed(text, '\n');
    std::erase_if(names, [](const std::string& name) { return name.starts_with('#'); });
  }
  if (names.empty()) throw InputError("{}: names no view; a list has one view name a line", file);
  const auto comma = std::find_if(names.begin(), names.end(),
                                  [](const std::string& name) { return name.find(',') != std::string::npos; });
  if (comma != names.end()) {
    throw InputError("{}: '{}' holds a comma; write one view name a line, and rename photos with commas", file,
                     Printable(*comma));
  }
  return fmt::format("{}", fmt::join(names, ","));
}

}  // namespace oraclegs
