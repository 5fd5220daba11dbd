#include "oraclegs/output/export.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "oraclegs/core/statistics.h"
#include "oraclegs/formats/spatial_order.h"
#include "oraclegs/gaussians/selection.h"
#include "oraclegs/output/format_loss.h"
#include "oraclegs/scene/frame_comments.h"
#include "oraclegs/workspace/non_commercial.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr int kZstdSpz = 4;  // a version of SPZ

/// An axis of a file, in the program's axes.
Eigen::Vector3d ProgramAxis(Eigen::Vector3d axis, unsigned half_turn) {
  for (int c = 0; c < 3; ++c) {
    if ((half_turn >> c & 1u) != 0) axis[c] = -axis[c];
  }
  return axis;
}

/// PSNR of what the written file shows to the model that it was made of.
double PsnrOfFile(const ExportFiles& files, const GaussianPly& model) {
  const SplatPromise& promise = SplatFormatOf(files.to, files.formats).promise;
  const bool exact = promise.position == 0 && promise.color == 0 && promise.harmonic == 0 && promise.lowest_color < -1;
  if (exact) return std::numeric_limits<double>::infinity();
  const GaussianPly file = ReadSplat(files.to, Silent(), files.formats);
  return PsnrFromAround(file.gaussians, model.gaussians, {.antialiased = model.antialiased});
}

}  // namespace

bool NeedsCameras(const ExportOptions& options) { return options.crop == "auto" || options.up == "auto"; }

GaussianPly Pruned(const GaussianPly& splat, const ExportOptions& options, const Crop& crop, const std::string& file) {
  const Gaussians& gaussians = splat.gaussians;
  gaussians.Check("Pruned");
  if (options.min_support > 0 && splat.marks.support.empty()) {
    throw InputError(
        "{}: says nothing of the support of its Gaussians, which --min-support goes by; give a model that "
        "oraclegs has trained and evaluated, or leave the option out",
        file);
  }
  if (options.max_uncertainty < 1 && splat.marks.uncertainty.empty()) {
    throw InputError(
        "{}: says nothing of how sure its Gaussians are, which --max-uncertainty goes by; give a model that "
        "oraclegs has trained, or leave the option out",
        file);
  }
  const float* logits = gaussians.opacity_logits.data();
  const std::vector<bool> outliers = options.remove_outliers ? OutlierGaussians(gaussians) : std::vector<bool>();
  std::vector<int64_t> kept;
  for (int64_t i = 0; i < gaussians.size(); ++i) {
    const Eigen::Vector3d mean = Eigen::Map<const Eigen::Vector3f>(gaussians.means.data() + 3 * i).cast<double>();
    const bool keep =
        Sigmoid(logits[i]) >= options.min_opacity && crop.Holds(mean) && (outliers.empty() || !outliers[i]) &&
        (options.min_support <= 0 || splat.marks.support[i] >= static_cast<float>(options.min_support)) &&
        (options.max_uncertainty >= 1 || splat.marks.uncertainty[i] <= static_cast<float>(options.max_uncertainty));
    if (keep) kept.push_back(i);
  }
  if (options.max_gaussians > 0) kept = MostPresent(gaussians, std::move(kept), options.max_gaussians);
  return {Picked(gaussians, kept), std::min(options.sh_degree, splat.sh_degree), splat.comments,
          Picked(splat.marks, kept), splat.antialiased};
}

void CheckExport(const ExportFiles& files, const ExportOptions& options) {
  const auto& [from, to, formats] = files;
  CheckOptions(options);
  std::error_code ignored;
  if (to.filename().empty() || fs::is_directory(to, ignored)) {
    throw UsageError("{}: is a folder; name the file to write, for example {}", to.string(),
                     (to / "scene.spz").string());
  }
  const SplatFormat& format = SplatFormatOf(to, formats);
  if (options.spz_version != ExportOptions{}.spz_version && format.extension != ".spz") {
    throw UsageError("{}: is no .spz file, which --spz-version is for; leave the option out or name a .spz",
                     to.string());
  }
  if (fs::equivalent(from, to, ignored)) {
    throw UsageError("{}: is the input itself, which an export never overwrites; choose another -o", to.string());
  }
  ParseCrop(options.crop);
  ParseAxis(options.up);
}

ExportResult ExportSplat(const ExportFiles& files, const ExportOptions& options,
                         const std::optional<ExportCameras>& cameras, const Listener& listener) {
  CheckExport(files, options);
  const auto& [from, to, formats] = files;
  const std::string file = from.string();
  if (NeedsCameras(options) && !cameras) {
    throw UsageError("{}: has no cameras, which {} needs; give the workspace of a run", file,
                     options.crop == "auto" ? "--crop auto" : "--up auto");
  }
  const SplatFormat& format = SplatFormatOf(to, formats);
  const GaussianPly splat = ReadSplat(from, listener, formats);
  const Eigen::Vector3d offset = OffsetOf(splat.comments);
  Crop crop = ParseCrop(options.crop).MovedBy(-offset);
  if (crop.kind == Crop::Kind::kAuto) {
    crop.kind = Crop::Kind::kBall;
    crop.ball = cameras->looked_at;
  }
  GaussianPly kept = Pruned(splat, options, crop, file);
  if (kept.gaussians.size() == 0) {
    throw UsageError(
        "{}: no Gaussian is left of {}; lower --min-opacity or --min-support, raise --max-uncertainty, or crop less",
        file, splat.gaussians.size());
  }
  const std::optional<double> unit = UnitMetersOf(splat.comments);
  const double scale = options.scale.ValueOr(unit.value_or(1));
  if (!options.up.empty() || scale != 1) {
    Similarity transform;
    transform.scale = scale;
    if (!options.up.empty()) {
      const Eigen::Vector3d usual = -Eigen::Vector3d::UnitY();  // up where y points down
      const auto axis = ParseAxis(options.up);
      const Eigen::Vector3d wanted = axis ? ProgramAxis(*axis, format.half_turn) : usual;
      transform.rotation = TurnBetween(cameras ? cameras->up : usual, wanted);
    }
    kept.gaussians = Transformed(kept.gaussians, transform);
    kept.comments = WithUnit(kept.comments, unit ? std::optional(*unit / scale) : std::nullopt);
    kept.comments = WithOffset(kept.comments, transform * offset);
    if (!options.up.empty()) kept.comments = WithoutLevel(std::move(kept.comments));
  }
  if (!format.keeps_comments) {
    for (const std::string& comment : LicenseComments(PartsInComments(kept.comments)))
      listener(Note{fmt::format("{} has no room for a comment of the model: {}", format.extension, comment)});
    if (const Eigen::Vector3d left = OffsetOf(kept.comments); !left.isZero(0)) {
      listener(Note{fmt::format("{} has no room for the scene's offset: add {} {} {} to positions for the scene's own",
                                format.extension, left.x(), left.y(), left.z())});
    }
  }
  const int degree = std::min(kept.sh_degree, format.max_sh_degree);
  const int64_t written = WriteSplat(to, kept, listener, options.spz_version == kZstdSpz ? WithSpz4(formats) : formats);
  listener(FileWritten{to});
  return {format.extension, splat.gaussians.size(), written, degree, fs::file_size(to), PsnrOfFile(files, kept)};
}

}  // namespace oraclegs
