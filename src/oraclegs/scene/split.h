#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "oraclegs/core/options.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// Which of n views in order `views` takes: the positions linspace(0, n-1, N), made whole.
enum class ViewSteps {
  kTruncate,  ///< as on Mip-NeRF 360 [Barron 2022]
  kRound,     ///< half to even, as on LLFF [Niemeyer 2022]
};
template <>
struct EnumWords<ViewSteps> {
  static constexpr EnumWord<ViewSteps> kWords[] = {{ViewSteps::kTruncate, "truncate"}, {ViewSteps::kRound, "round"}};
};

struct SplitOptions {
  bool eval = false;  ///< hold views out for testing
  Auto<int> test_every =
      {};         ///< every n-th view by name is a test view, 0 = no test views; auto = 8 with `eval`, else 0
  int views = 0;  ///< training views, 0 = all that are not test views
  ViewSteps view_steps = ViewSteps::kTruncate;
  std::string train_views{};  ///< a list as view_list.h reads it; the candidates for `views`
  std::string test_views{};   ///< likewise; replaces test_every

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("eval", self.eval,
          "Hold every 8th view out and score the result on it; otherwise all photos train. Scenes with a test file of "
          "their own (Blender) always use it");
    visit("test-every", self.test_every,
          "Every n-th view in name order, from the first, is held out for testing; 0 = none; auto = 8 with --eval, "
          "else 0",
          Range{0, 1e6});
    visit("views", self.views, "Training views, picked evenly from the rest, at linspace(0, n-1, N); 0 = all",
          Range{0, 1e6});
    visit("view-steps", self.view_steps,
          "How these positions become whole: truncate, as papers on Mip-NeRF 360 do, or round, as those on LLFF do",
          Tier::kSetting);
    visit("train-views", self.train_views,
          "The training views: names, with or without folder and extension, and positions in name order, :0 the first, "
          "joined by commas; or @FILE with one a line, or with the JSON of a run's split.json");
    visit("test-views", self.test_views, "The test views, likewise; replaces --eval and --test-every");
  }
};

/// Indices into Scene::views, ascending by name.
struct Split {
  std::vector<int> train, test;
};

/// The options with the lists of files in place of their names. Throws InputError as ExpandViewList does.
SplitOptions WithListsRead(const SplitOptions& options);

/// The protocol of the sparse-view papers (docs/method.md#train-and-test-views). It counts photos: all faces of a
/// sphere train, or all of them test. `options` are WithListsRead. Throws
/// InputError when fewer than two training views are left or more are asked for than exist, a named view does not, or
/// one is named in both lists.
Split SplitViews(const Scene& scene, const SplitOptions& options);

/// {"train": [names], "test": [names]}
nlohmann::json SplitToJson(const Scene& scene, const Split& split);

}  // namespace oraclegs
