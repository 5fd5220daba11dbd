#pragma once
// Figures of papers: proposals with their confidence, renders of several runs side by side, or of a whole benchmark.

#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/core/options.h"
#include "oraclegs/output/figures/sheet.h"
#include "oraclegs/stages/stage.h"

namespace oraclegs {

enum class FigureKind { kConfidence, kComparison };
template <>
struct EnumWords<FigureKind> {
  static constexpr EnumWord<FigureKind> kWords[] = {{FigureKind::kConfidence, "confidence"},
                                                    {FigureKind::kComparison, "comparison"}};
};

struct FigureOptions {
  Auto<FigureKind> kind;
  std::string show, crop, labels;
  int rows = 4, panel_width = 240;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit(
        "kind", self.kind,
        "confidence = proposals, their confidence (plasma), and the photo of their pose where there is one; comparison "
        "= renders of the test views of one or more runs beside the photos; auto = confidence for one workspace, "
        "comparison for several");
    visit(
        "show", self.show,
        "Names of the proposals or test views to show, separated by commas; without, some evenly, and of a benchmark's "
        "scene the view with the median PSNR");
    visit("rows", self.rows, "How many to show where --show names none", Range{1, 100});
    visit("crop", self.crop, "Of renders: the part to show, X,Y,WIDTH,HEIGHT in pixels");
    visit("labels", self.labels,
          "Of renders: what the runs or methods are called, separated by commas; without, as their folders and tables");
    visit("panel-width", self.panel_width, "Width of an image in the PNG, pixels", Range{32, 4096});
  }
};

/// Proposals of a run with the maps of stage "validate"; photos come from views that neither train nor test. Throws
/// InputError when there are none, and when --show names another.
Sheet ConfidenceSheet(const Run& run, const FigureOptions& options);

/// Renders of stage "evaluate" of runs of one scene, with the PSNR of each, and the photos. Throws InputError for a
/// folder without renders, renders of different sizes and a view that one run lacks; UsageError for a crop outside the
/// renders and a wrong number of labels.
Sheet ComparisonSheet(const std::vector<std::filesystem::path>& workspaces, const FigureOptions& options);

/// True for the folder of a benchmark (`oraclegs bench`).
bool IsSuiteFolder(const std::filesystem::path& folder);

/// Renders of a benchmark: a row for each scene and number of views, the photo and each method's render of one test
/// view, with its PSNR. The view is the first that --show names, else the one in whose PSNR the first method with
/// scores is at its median. A method with several seeds is shown by the first with scores; the place of a run without
/// scores has its reason. Throws InputError for a folder without scores; UsageError as ComparisonSheet.
Sheet SuiteSheet(const std::filesystem::path& folder, const FigureOptions& options);

}  // namespace oraclegs
