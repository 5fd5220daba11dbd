
#include "oraclegs/core/files.h"
#include "oraclegs/output/report/orbit_video.h"
#include "oraclegs/output/report/report_files.h"
#include "oraclegs/output/report/run_document.h"
#include "oraclegs/stages/evaluate_stage.h"
#include "oraclegs/stages/stage_seconds.h"
#include "oraclegs/web/assets.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

void AddReportKey(Run* run, Fingerprint* key) {
  for (const char* name : {"report.html", "report.js", "report.css"}) {
    if (const auto asset = FindWebAsset(name)) key->Add(asset->bytes);
  }
  key->Add(run->version).Add(run->options.report.orbit_frames);
  for (const fs::path& file : {run->workspace.metrics(), run->workspace.root() / "oracle.json"}) {
    std::error_code ignored;
    if (fs::exists(file, ignored)) key->AddFile(file);
  }
}

void UndoReport(Run* run, const nlohmann::json&) {
  std::error_code ignored;
  fs::remove(run->workspace.report_page(), ignored);
}

std::optional<nlohmann::json> MakeReport(Run* run, const std::string&) {
  Model model = LoadModel(run->workspace.point_cloud(), run->options, run->plan.device, run->frame);
  model.others =
      ModelsBeside(run->workspace, run->workspace.Record("train"), run->plan.device, Silent());  // evaluation warned
  OrbitVideo film;
  film.frames = run->options.report.orbit_frames;
  const fs::path video = WriteOrbitVideo(*run, model, film);
  return nlohmann::json{{"files", WriteReport(run, model, video)}};
}

}  // namespace

std::vector<std::string> WriteReport(Run* run, const Model& model, const fs::path& video) {
  const nlohmann::json document = WriteRunDocument(run, model, video);
  std::vector<std::string> files = {"report/run.json"};
  if (WebPagesBuilt()) {
    WriteFileAtomically(run->workspace.report_page(),
                        SelfContainedPage(WithFilesInside(document, run->workspace.root())));
    files.push_back("report.html");
    run->listener(FileWritten{run->workspace.report_page()});
  } else {
    run->listener(Note{fmt::format("no report.html: {}", HowToBuildWebPages())});
  }
  return files;
}

StageWork ReportStage() {
  return {.wanted = [](const Run& run) { return run.options.report.report; },
          .own = AddReportKey,
          .undo = UndoReport,
          .make = MakeReport,
          .summary = [](const nlohmann::json&) { return std::string("report.html"); },
          .seconds =
              [](const EstimateInput& input) {
                constexpr double kReport = 0.5, kReportOfPixel = 1e-6, kLoadOfPixel = 26e-9;
                const double views = input.scene.views + input.test_views;
                return kReport + kReportOfPixel * CoveredPixels(input) * views +
                       kLoadOfPixel * FullPixels(input) * views +
                       SecondsOfRender(input) * input.options.report.orbit_frames;
              }};
}

}  // namespace oraclegs
