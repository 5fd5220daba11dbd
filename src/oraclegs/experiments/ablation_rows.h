#pragma once
// Rows of an ablation: those of Table 3 of the OracleGS paper in its order, then the parts that only this program has;
// and the numbers that the paper prints for them.

#include <string>
#include <vector>

#include "oraclegs/settings/options.h"

namespace oraclegs {

/// One part of the program. Each row trains with everything that the rows above it switched on.
struct AblationRow {
  const char* name;         ///< for --rows and folders
  const char* label;        ///< for tables
  const char* explanation;  ///< the part that it adds, in one sentence
  /// Changes the options of the row above. Values come from `asked`, the options that the whole ablation was asked for,
  /// so that the last row has the result of `reconstruct`.
  void (*apply)(const RunOptions& asked, RunOptions* options);
};

/// All rows have the iterations, the horizon and the most Gaussians that are asked for. Up to "dense" they train as
/// Published3dgs() says, with or without a preset, but for the parts that the rows add.
const std::vector<AblationRow>& AblationRows();

/// Options of a row, an index of AblationRows(). The last row has `asked`.
RunOptions RowOptions(size_t row, const RunOptions& asked);

/// Rows that --rows names by number (from 1) or name, separated by commas, in the order of the table; all of them for
/// "". Throws UsageError that lists the rows.
std::vector<size_t> ChooseRows(const std::string& words);

/// Throws UsageError when `asked` has no proposals or fixes the start, on which several rows depend.
void RequireAblatable(const RunOptions& asked);

/// Throws what WithNetworksAtHand and MakePlan throw of networks that `asked` needs: the first rows ask none, and would
/// train before the first row that does is refused.
void RequireNetworksOfRows(const RunOptions& asked);

/// Row of the ablation on Mip-NeRF 360 ([Topaloglu 2026], table 3): means over its scenes.
struct PublishedStep {
  std::string row;   ///< AblationRow::name
  std::string psnr;  ///< dB, as printed; "29.85*" is a misprint, with which no difference is formed
  double ssim = 0, lpips = 0;
};

/// The rows for 12 or 24 training views, in their order; empty for another number.
std::vector<PublishedStep> PublishedSteps(int views);

/// 12 or 24 where a scene of that table, by the name of its folder, is split and sized as there; 0 for all others.
int ViewsOfPublishedSteps(const std::string& scene, const RunOptions& options);

/// True when these are all scenes of that table, in any order.
bool AreScenesOfPublishedSteps(std::vector<std::string> scenes);

}  // namespace oraclegs
