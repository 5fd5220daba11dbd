#include <system_error>
#include <utility>

#include "oraclegs/capture/mask_command.h"
#include "oraclegs/core/text.h"
#include "oraclegs/stages/stage_seconds.h"
#include "oraclegs/stages/stage_works.h"

namespace oraclegs {
namespace {

void AddMasksKey(Run* run, Fingerprint* key) {
  std::vector<std::filesystem::path> photos;
  for (const SceneView& view : run->scene.views) photos.push_back(view.image_path);
  run->files.Read(photos);
  key->Add(run->options.masks.masks);
  for (const SceneView& view : run->scene.views) {
    key->Add(view.name).Add(view.as_stored).Add(run->files.Of(view.image_path));
  }
}

bool LoadMasks(Run* run) {
  Scene masked = run->scene;  // a damaged mask leaves the scene as it was: a face keeps its own
  TakeMasks(run->workspace.masks(), run->listener, &masked);
  run->scene = std::move(masked);
  return true;
}

std::optional<nlohmann::json> MakeAndTakeMasks(Run* run, const std::string&) {
  const MaskRun masks{run->options.masks.masks, run->options.generator_limits.generator_timeout,
                      run->workspace.masks()};
  MakeMasks(masks, run->scene, run->listener);
  LoadMasks(run);
  return nlohmann::json{{"photos", run->scene.views.size()}, {"files", {"masks"}}};
}

}  // namespace

StageWork MasksStage() {
  return {.wanted = [](const Run& run) { return !run.options.masks.masks.empty(); },
          .own = AddMasksKey,
          .undo =
              [](Run* run, const nlohmann::json&) {
                std::error_code ignored;
                std::filesystem::remove_all(run->workspace.masks(), ignored);
              },
          .make = MakeAndTakeMasks,
          .load = LoadMasks,
          .summary = [](const nlohmann::json& r) { return Counted(CountIn(r, "photos"), "mask"); },
          .seconds =
              [](const EstimateInput& input) {
                constexpr double kWriteOfPixel = 0.1e-6;  // of the request; nobody knows how long the command takes
                return kWriteOfPixel * FullPixels(input) * input.scene.views;
              },
          .uses_network = [](const Run&) { return true; }};
}

}  // namespace oraclegs
