#pragma once

#include <filesystem>

#include "oraclegs/core/options.h"
#include "oraclegs/gaussians/gaussians.h"

namespace oraclegs {

struct ExportOptions {
  int sh_degree = 3;
  double min_opacity = 0;
  int max_gaussians = 0;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("sh-degree", self.sh_degree, "Highest degree of the view-dependent colour that is kept", Range{0, 3});
    visit("min-opacity", self.min_opacity, "Gaussians fainter than this are left out", Range{0, 1});
    visit("max-gaussians", self.max_gaussians, "Keep this many, those of most opacity times area; 0 = all",
          Range{0, 1e9});
  }
};

/// What the options leave of a model, in its order.
Gaussians Pruned(const Gaussians& gaussians, const ExportOptions& options);

struct ExportResult {
  int64_t before = 0, after = 0;  ///< Gaussians
  int sh_degree = 0;              ///< of the written file
};

/// Reads a PLY, prunes it, writes it with its comments. Throws InputError, RunError; UsageError when nothing would be
/// left.
ExportResult ExportPly(const std::filesystem::path& from, const std::filesystem::path& to,
                       const ExportOptions& options);

}  // namespace oraclegs
