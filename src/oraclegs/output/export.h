#pragma once

#include <filesystem>
#include <optional>

#include "oraclegs/core/options.h"
#include "oraclegs/core/progress.h"
#include "oraclegs/formats/splat_file.h"
#include "oraclegs/output/model_edits.h"

namespace oraclegs {

struct ExportOptions {
  int sh_degree = 3;
  double min_opacity = 0;
  double min_support = 0;
  double max_uncertainty = 1;
  int max_gaussians = 0;
  bool remove_outliers = false;
  std::string crop = {};
  std::string up = {};
  Auto<double> scale = {};
  int spz_version = 3;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("sh-degree", self.sh_degree, "Highest degree of the view-dependent color that is kept", Range{0, 3});
    visit("min-opacity", self.min_opacity, "Gaussians fainter than this are left out", Range{0, 1});
    visit("min-support", self.min_support,
          "Gaussians that the images support less are left out: 0.25 the weakly supported, 0.5 also the proposed, "
          "0.75 also those of one image; needs a model that this program trained",
          Range{0, 1});
    visit(
        "max-uncertainty", self.max_uncertainty,
        "Gaussians that are less sure than this are left out: the error of their color to expect, in shares of white; "
        "0.05 leaves little to doubt; needs a model that this program trained",
        Range{0, 1});
    visit("max-gaussians", self.max_gaussians, "Keep this many, those of most opacity times area; 0 = all",
          Range{0, 1e9});
    visit("remove-outliers", self.remove_outliers, "Leave out small Gaussians that are far from all others");
    visit("crop", self.crop, kCropHelp);
    visit(
        "up", self.up,
        "Turn the model so that up is this axis of the file: x, -x, y, -y, z, -z, or auto: what viewers of the format "
        "expect");
    visit("scale", self.scale,
          "Make the model this many times as large; auto = such that a unit is a meter, where the model says how long "
          "its units are, else 1",
          Range{1e-6, 1e6});
    visit("spz-version", self.spz_version,
          "Version of a .spz file: 3, which all of its viewers open, or 4, the same numbers packed by zstd",
          Range{3, 4});
  }
};

/// Facts about the cameras that an export uses.
struct ExportCameras {
  Ball looked_at;
  Eigen::Vector3d up;  ///< unit vector
};

/// True when the options need cameras.
bool NeedsCameras(const ExportOptions& options);

/// Gaussians of a model, in their order, that the options keep. Throws UsageError and InputError; `file` is named in
/// errors.
GaussianPly Pruned(const GaussianPly& splat, const ExportOptions& options, const Crop& crop, const std::string& file);

struct ExportResult {
  std::string extension;          ///< end of the written file's name: ".spz"
  int64_t before = 0, after = 0;  ///< Gaussians
  int sh_degree = 0;              ///< SH degree of the written file
  uint64_t bytes = 0;             ///< size of the written file
  double psnr = 0;                ///< of its renders to those of the edited model (format_loss.h), dB
};

struct ExportFiles {
  std::filesystem::path from, to;
  const std::vector<SplatFormat>& formats = SplatFormats();
};

/// Throws UsageError for options and an output that can be refused before anything is read.
void CheckExport(const ExportFiles& files, const ExportOptions& options);

/// Reads a splat of any format, edits it and writes it in the format that the name of `to` ends with. Throws InputError
/// and RunError; UsageError when no Gaussian would be left, or when cameras are needed and missing.
ExportResult ExportSplat(const ExportFiles& files, const ExportOptions& options,
                         const std::optional<ExportCameras>& cameras, const Listener& listener);

}  // namespace oraclegs
