#include "oraclegs/pipeline/stages/oracle_report.h"

#include <cmath>

#include "oraclegs/core/files.h"
#include "oraclegs/evaluate/oracle_quality.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/pipeline/stages/propose_stage.h"
#include "oraclegs/propose/proposal_files.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {

nlohmann::json ReportOracle(const Run& run) {
  const nlohmann::json record = run.workspace.Record("validate");
  const nlohmann::json validated =
      record.is_object() ? record.value("mean_confidence", nlohmann::json::object()) : nlohmann::json::object();
  std::vector<float> errors, confidence;
  double psnr = 0;
  int views = 0;
  for (const int v : SpareViews(run)) {
    const std::string stem = FileName(run.scene.views[static_cast<size_t>(v)].name), name = stem + ".png";
    if (!validated.contains(stem)) continue;
    const auto image = run.workspace.proposals() / name, map = run.workspace.confidence() / name;
    const LoadedView truth = LoadViews(run.scene, {v}, run.options.image, run.listener).front();
    const ImageF proposal = ToFloat(ReadImage(image)), trust = ToFloat(ReadImage(map));
    if (proposal.data.size() != truth.rgb.data.size() || trust.data.size() != truth.rgb.data.size()) {
      throw InputError("{}: is not of its view's size; delete it and run `oraclegs validate` again", image.string());
    }
    double squares = 0;
    size_t counted = 0;
    for (size_t i = 0; i < truth.rgb.data.size() / 3; ++i) {
      if (!truth.mask.empty() && truth.mask[i] == 0) continue;
      float error = 0;
      for (size_t c = 3 * i; c < 3 * i + 3; ++c) {
        const float d = proposal.data[c] - truth.rgb.data[c];
        error += std::abs(d) / 3;
        squares += static_cast<double>(d) * static_cast<double>(d);
      }
      errors.push_back(error);
      confidence.push_back(trust.data[3 * i]);
      ++counted;
    }
    if (counted == 0) continue;
    psnr -= 10 * std::log10(squares / (3 * static_cast<double>(counted)));
    ++views;
  }
  if (validated.empty()) {
    throw InputError(
        "{}: holds no validated proposals; run `oraclegs validate` with --trajectory dataset and --views N below the "
        "number of photos",
        run.workspace.root().string());
  }
  if (views == 0) {
    throw InputError(
        "{}: no proposal has the pose of a view that neither trains nor tests; only --trajectory dataset "
        "with --views N below the number of photos can be measured",
        run.workspace.root().string());
  }
  nlohmann::json report = {
      {"views", views},
      {"psnr", psnr / views},
      {"oracle", ToJson(OracleQuality::FromPixels(errors, confidence))},
      {"uniform", ToJson(OracleQuality::FromPixels(errors, std::vector<float>(errors.size(), 1.f)))}};
  WriteFileAtomically(run.workspace.root() / "oracle.json", report.dump(2) + "\n");
  return report;
}

}  // namespace oraclegs
