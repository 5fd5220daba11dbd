#include "oraclegs/stages/oracle_report.h"

#include <cmath>

#include "oraclegs/core/files.h"
#include "oraclegs/evaluate/block_quality.h"
#include "oraclegs/evaluate/oracle_quality.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/propose/proposal_files.h"
#include "oraclegs/scene/loaded_view.h"
#include "oraclegs/stages/propose_stage.h"

namespace oraclegs {
namespace {

/// Proposals whose images exist, all together.
struct MeasuredProposals {
  std::vector<float> errors, confidence;  ///< values of the pixels that count
  BlockSamples blocks, uniform_blocks;
  double psnr = 0;  ///< sum over the views
  int views = 0;

  /// Compares the proposal at a view's pose with its image. Throws InputError for files of another size.
  void Add(const Run& run, int v) {
    const std::string name = FileName(run.scene.views[static_cast<size_t>(v)].name) + ".png";
    const auto image = run.workspace.proposals() / name, map = run.workspace.confidence() / name;
    const LoadedView truth = LoadViews(run.scene, {v}, run.plan.image, run.listener).front();
    const ImageF proposal = ToFloat(ReadImage(image)), trust = ToFloat(ReadImage(map));
    if (proposal.data.size() != truth.rgb.data.size() || trust.data.size() != truth.rgb.data.size()) {
      throw InputError("{}: is not of its view's size; delete it and run `oraclegs validate` again", image.string());
    }
    ErrorMap of_view{truth.rgb.width, truth.rgb.height, {}, {}, {}};
    double squares = 0;
    size_t counted = 0;
    for (size_t i = 0; i < truth.rgb.data.size() / 3; ++i) {
      float error = 0;
      double of_pixel = 0;
      for (size_t c = 3 * i; c < 3 * i + 3; ++c) {
        const float d = proposal.data[c] - truth.rgb.data[c];
        error += std::abs(d) / 3;
        of_pixel += static_cast<double>(d) * static_cast<double>(d);
      }
      of_view.error.push_back(error);
      of_view.confidence.push_back(trust.data[3 * i]);
      of_view.counts.push_back(truth.mask.empty() || truth.mask[i] != 0);
      if (!of_view.counts.back()) continue;
      errors.push_back(error);
      confidence.push_back(trust.data[3 * i]);
      squares += of_pixel;
      ++counted;
    }
    if (counted == 0) return;
    blocks.Add(of_view);
    of_view.confidence.assign(of_view.confidence.size(), 1.f);
    uniform_blocks.Add(of_view);
    psnr -= 10 * std::log10(squares / (3 * static_cast<double>(counted)));
    ++views;
  }

  nlohmann::json Quality(const BlockSamples& of_blocks, const std::vector<float>& of_pixels) const {
    nlohmann::json quality = ToJson(OracleQuality::FromPixels(errors, of_pixels));
    quality["blocks"] = ToJson(of_blocks.Quality());
    return quality;
  }
};

}  // namespace

nlohmann::json ReportOracle(const Run& run) {
  const nlohmann::json record = run.workspace.Record("validate");
  const nlohmann::json validated =
      record.is_object() ? record.value("mean_confidence", nlohmann::json::object()) : nlohmann::json::object();
  MeasuredProposals measured;
  for (const int v : SpareViews(run)) {
    if (validated.contains(FileName(run.scene.views[static_cast<size_t>(v)].name))) measured.Add(run, v);
  }
  if (validated.empty()) {
    throw InputError(
        "{}: holds no validated proposals; run `oraclegs validate` with --trajectory dataset and --views N below the "
        "number of photos",
        run.workspace.root().string());
  }
  if (measured.views == 0) {
    throw InputError(
        "{}: no proposal has the pose of a view that neither trains nor tests; only --trajectory dataset "
        "with --views N below the number of photos can be measured",
        run.workspace.root().string());
  }
  nlohmann::json report = {
      {"views", measured.views},
      {"psnr", measured.psnr / measured.views},
      {"oracle", measured.Quality(measured.blocks, measured.confidence)},
      {"uniform", measured.Quality(measured.uniform_blocks, std::vector<float>(measured.errors.size(), 1.f))}};
  WriteFileAtomically(run.workspace.root() / "oracle.json", report.dump(2) + "\n");
  return report;
}

}  // namespace oraclegs
