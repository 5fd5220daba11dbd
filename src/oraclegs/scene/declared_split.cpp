#include "oraclegs/scene/declared_split.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <unordered_map>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/plural.h"
#include "oraclegs/core/text.h"
#include "oraclegs/scene/named_files.h"
#include "oraclegs/scene/view_list.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

std::string NormalName(const std::string& written) { return ViewName(WithSlashes(written)); }

/// Sets the role of the frames that a list of the file names.
void TakeList(const nlohmann::json& file, const char* key, DeclaredRole role,
              const std::unordered_map<std::string, size_t>& frame_of, std::vector<DeclaredRole>* roles) {
  const auto list = file.find(key);
  if (list == file.end() || !list->is_array()) return;
  for (const nlohmann::json& name : *list) {
    if (!name.is_string()) continue;
    const auto frame = frame_of.find(NormalName(name.get<std::string>()));
    if (frame != frame_of.end()) (*roles)[frame->second] = role;
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
bool NamesViews(const fs::path& list, const std::string& part, const std::set<std::string>& names) {
  try {
    const std::vector<std::string> items = SplitTrimmed(ExpandViewList("@" + list.string(), part), ',');
    return std::any_of(items.begin(), items.end(), [&](const std::string& item) {
      return names.count(fs::path(NormalName(item)).stem().string()) > 0;
    });
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace

std::vector<DeclaredRole> RolesInTransforms(const nlohmann::json& file, const std::vector<std::string>& written) {
  std::vector<DeclaredRole> roles(written.size(), DeclaredRole::kNone);
  std::unordered_map<std::string, size_t> frame_of;
  for (size_t i = 0; i < written.size(); ++i) frame_of.emplace(NormalName(written[i]), i);
  const bool has_test = HasList(file, "test_filenames");
  TakeList(file, "train_filenames", DeclaredRole::kTrain, frame_of, &roles);
  TakeList(file, "val_filenames", has_test ? DeclaredRole::kVal : DeclaredRole::kTest, frame_of, &roles);
  TakeList(file, "test_filenames", DeclaredRole::kTest, frame_of, &roles);
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
    for (const std::string part : {"train", "test"}) {
      for (const char* pattern : {"{}.txt", "{}_list.txt", "{}_images.txt", "split.json", "train_test_split.json"}) {
        const fs::path list = dir / fmt::format(fmt::runtime(pattern), part);
        if (IsFile(list) && NamesViews(list, part, names)) {
          ways.push_back(fmt::format("--{}-views @{}", part, ShellQuoted(list.string())));
        }
      }
    }
  }
  if (ways.empty()) return;
  listener(Note{fmt::format("{}: has lists of views, which are not used; to use them, add {}", scene.root.string(),
                            fmt::join(ways, " "))});
}

}  // namespace oraclegs
