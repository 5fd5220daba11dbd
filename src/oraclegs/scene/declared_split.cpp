#include "oraclegs/scene/declared_split.h"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"
#include "oraclegs/scene/named_files.h"
#include "oraclegs/scene/view_list.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

std::string NormalName(const std::string& written) { return ViewName(WithSlashes(written)); }

std::string WithoutItsExtension(const std::string& name) { return fs::path(name).replace_extension().generic_string(); }

/// Frames by their names, also by those that only one has when extensions do not count.
class FramesByName {
 public:
  explicit FramesByName(const std::vector<std::string>& written) {
    for (size_t i = 0; i < written.size(); ++i) {
      const std::string name = NormalName(written[i]);
      exact_.emplace(name, i);
      for (const std::string& key : {name, WithoutItsExtension(name)}) {
        const auto [it, is_new] = loose_.emplace(key, i);
        if (!is_new && it->second != i) it->second = kSeveral;
      }
    }
  }

  std::optional<size_t> Find(const std::string& written) const {
    const std::string name = NormalName(written);
    if (const auto frame = exact_.find(name); frame != exact_.end()) return frame->second;
    for (const std::string& key : {name, WithoutItsExtension(name)}) {
      const auto frame = loose_.find(key);
      if (frame != loose_.end() && frame->second != kSeveral) return frame->second;
    }
    return std::nullopt;
  }

 private:
  static constexpr size_t kSeveral = std::numeric_limits<size_t>::max();
  std::unordered_map<std::string, size_t> exact_, loose_;
};

/// Sets the role of the frames that a list of the file names. Names of no frame go to `unknown`.
void TakeList(const nlohmann::json& list, DeclaredRole role, const FramesByName& frames,
              std::vector<DeclaredRole>* roles, std::vector<std::string>* unknown) {
  for (const nlohmann::json& name : list) {
    if (!name.is_string()) continue;
    const auto frame = frames.Find(name.get<std::string>());
    if (frame) (*roles)[*frame] = role;
    if (!frame) unknown->push_back(OneLine(name.get<std::string>()));
  }
}

bool HasList(const nlohmann::json& file, const char* key) {
  const auto list = file.find(key);
  return list != file.end() && list->is_array() && !list->empty();
}

size_t CountRole(const Scene& scene, DeclaredRole role) {
  return static_cast<size_t>(std::count_if(scene.views.begin(), scene.views.end(),
                                           [role](const SceneView& view) { return view.role == role; }));
}

/// True for a list that names a view of the scene.
bool NamesViews(const fs::path& list, const std::string& role, const std::set<std::string>& names) {
  try {
    const std::vector<std::string> items = SplitTrimmed(ExpandViewList("@" + list.string(), role), ',');
    return std::any_of(items.begin(), items.end(), [&](const std::string& item) {
      return names.count(fs::path(NormalName(item)).stem().string()) > 0;
    });
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace

std::vector<DeclaredRole> RolesInTransforms(const nlohmann::json& file, const std::vector<std::string>& written,
                                            const std::string& source, const Listener& listener) {
  std::vector<DeclaredRole> roles(written.size(), DeclaredRole::kNone);
  const FramesByName frames(written);
  const DeclaredRole of_val = HasList(file, "test_filenames") ? DeclaredRole::kVal : DeclaredRole::kTest;
  const std::pair<const char*, DeclaredRole> kLists[] = {
      {"train_filenames", DeclaredRole::kTrain}, {"val_filenames", of_val}, {"test_filenames", DeclaredRole::kTest}};
  std::vector<std::string> unknown;
  for (const auto& [key, role] : kLists) {
    if (HasList(file, key)) TakeList(file[key], role, frames, &roles, &unknown);
  }
  if (!unknown.empty()) {
    listener(Warning{fmt::format("{}: its lists of training and test views have {} that no frame has; {} left out: {}",
                                 source, Counted(unknown.size(), "name"), unknown.size() == 1 ? "it is" : "they are",
                                 SomeNames(unknown))});
  }
  return roles;
}

void ReportDeclaredSplit(const Scene& scene, const std::string& source, const Listener& listener) {
  const size_t train = CountRole(scene, DeclaredRole::kTrain), test = CountRole(scene, DeclaredRole::kTest);
  if (train + test == 0) return;
  const size_t others = train == 0 ? 0 : scene.views.size() - train - test;
  listener(Note{
      fmt::format("{}: its lists name {} and {}{}; --eval, --test-every, --train-views and --test-views overrule them",
                  source, Counted(train == 0 ? scene.views.size() - test : train, "training view"),
                  Counted(test, "test view"), others == 0 ? "" : fmt::format(", and {} are in neither", others))});
}

void ReportSplitLists(const Scene& scene, const SplitOptions& options, const Listener& listener) {
  if (!options.train_views.empty() || !options.test_views.empty() || scene.format == SceneFormat::kBlender) return;
  std::set<std::string> names;
  for (const SceneView& view : scene.views) names.insert(fs::path(view.name).stem().string());
  std::vector<std::string> ways;
  for (const fs::path& dir : {scene.root, scene.root / "sparse", scene.root / "sparse/0", scene.root / "images"}) {
    for (const std::string role : {"train", "test"}) {
      for (const char* pattern : {"{}.txt", "{}_list.txt", "{}_images.txt", "split.json", "train_test_split.json"}) {
        const fs::path list = dir / fmt::format(fmt::runtime(pattern), role);
        if (IsFile(list) && NamesViews(list, role, names)) {
          ways.push_back(fmt::format("--{}-views @{}", role, ShellQuoted(list.string())));
        }
      }
    }
  }
  if (ways.empty()) return;
  listener(Note{fmt::format("{}: has lists of views, which are not used; to use them, add {}", scene.root.string(),
                            fmt::join(ways, " "))});
}

}  // namespace oraclegs
