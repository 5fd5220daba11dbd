#pragma once
// Figures of papers from workspaces: proposals with their confidence, or renders of several runs side by side.

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
    visit("show", self.show, "Names of the proposals or test views to show, separated by commas; without, some evenly");
    visit("rows", self.rows, "How many to show where --show names none", Range{1, 100});
    visit("crop", self.crop, "Of a comparison: the part to show, X,Y,WIDTH,HEIGHT in pixels of the renders");
    visit("labels", self.labels,
          "Of a comparison: what the runs are called, separated by commas; without, their folders");
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

}  // namespace oraclegs
