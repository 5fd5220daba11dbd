#pragma once
// The OracleGS paper's numbers for the rows of its ablation.

#include <string>
#include <vector>

#include "oraclegs/settings/options.h"

namespace oraclegs {

/// Row of the ablation on Mip-NeRF 360 ([Topaloglu 2026], table 3): means over its scenes.
struct PublishedStep {
  std::string row;   ///< as in ablation_rows.h
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
