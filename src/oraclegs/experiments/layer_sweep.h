#pragma once
// Measures which layers of VGGT's attention tell where proposals are wrong (docs/method.md#vggt-oracle).

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/run/start.h"

namespace oraclegs {

/// How well the map of one layer, or of several together, orders the pixels of proposals by their error
/// (evaluate/oracle_quality.h).
struct LayerQuality {
  std::optional<int64_t> layer;              ///< nullopt = the layers that --oracle vggt combines
  std::optional<double> auroc_above_median;  ///< [0, 1], 0.5 = as good as chance; nullopt when all errors are equal
  std::optional<double> auroc_large_error;   ///< the same
  std::optional<double> ause_ratio;          ///< 0 = ideal order, 1 = random order
  double spearman = 0;                       ///< [-1, 1]
};

struct LayerSweep {
  std::string scene, command, version, network;
  size_t train_views = 0;
  int64_t views = 0;                 ///< proposals that have an image at their pose
  std::vector<LayerQuality> layers;  ///< the combination first, then each layer
};

/// Proposes views at the poses of images that neither train nor test, asks --oracle vggt for their confidence with
/// each layer alone, uncalibrated, and compares it with their errors. Nothing is trained. All layers share one
/// workspace, out/run. Writes out/layers.json, .md and .svg after each layer. Throws UsageError for options that
/// contradict it; InputError when the scene cannot be read, has no image at the pose of a proposal, or `out`
/// holds something else; and as the stages do. `command` is as typed, for the report.
LayerSweep RunLayerSweep(const RunRequest& request, const std::string& command, const Listener& listener);

nlohmann::json LayerSweepToJson(const LayerSweep& sweep);
/// Table with a line for each layer.
std::string LayerSweepText(const LayerSweep& sweep);
/// Document with a heading, the plot (layers.svg), the table and what its columns are.
std::string LayerSweepMarkdown(const LayerSweep& sweep);
/// AUROC over the layers as an SVG image, in per cent.
std::string LayerSweepPlot(const LayerSweep& sweep);

}  // namespace oraclegs
