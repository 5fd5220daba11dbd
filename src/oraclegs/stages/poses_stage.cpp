#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "oraclegs/core/text.h"
#include "oraclegs/depth/plane_search.h"
#include "oraclegs/depth/refine_poses.h"
#include "oraclegs/depth/stereo.h"
#include "oraclegs/depth/stereo_setup.h"
#include "oraclegs/stages/refined_poses.h"
#include "oraclegs/stages/stage_seconds.h"
#include "oraclegs/stages/stage_works.h"
#include "oraclegs/stages/stereo_of_run.h"

namespace oraclegs {
namespace {

using nlohmann::json;

constexpr int kMaxRefinements = 3;  // each with depth of its own; more of them only follow the noise of the offsets

constexpr int kMinSide = 90;      // pixels of an image in which refinement still sees something
constexpr double kMaxLeft = 0.5;  // pixels that a view may stay off by without a warning; below it the usual gate keeps

const char* WordOf(PoseRefinementResult result) {
  switch (result) {
    case PoseRefinementResult::kUnknown:
      return "unknown";
    case PoseRefinementResult::kKept:
      return "kept";
    case PoseRefinementResult::kRefined:
      return "refined";
    case PoseRefinementResult::kUndone:
      return "undone";
  }
  return "";
}

void AddPosesKey(Run* run, Fingerprint* key) {
  key->Add(ViewsKey(run, run->split.train, run->plan.image));
  key->Add(OptionsToJson(run->options.image).dump()).Add(OptionsToJson(run->options.stereo).dump());
  key->Add(run->options.depth.refine_poses == PoseRefining::kOn);
}

void UndoPoses(Run* run, const json&) {
  std::error_code ignored;
  std::filesystem::remove(run->workspace.refined_poses(), ignored);
}

/// The training views at this share of their working size, with these poses; nothing where they would be too small.
std::vector<LoadedView> SmallerViews(const Run& run, const std::vector<Camera>& cameras, int reduction) {
  ImageOptions smaller = run.plan.image;
  int longest = 0, shortest = std::numeric_limits<int>::max();
  for (const Camera& camera : cameras) {
    longest = std::max({longest, camera.width, camera.height});
    shortest = std::min({shortest, camera.width, camera.height});
  }
  if (shortest < kMinSide * reduction) return {};
  smaller.max_size = longest / reduction;
  std::vector<LoadedView> views = LoadViews(run.scene, run.split.train, smaller, Silent());
  for (size_t v = 0; v < views.size(); ++v) views[v].camera.cam_from_world = cameras[v].cam_from_world;
  return views;
}

/// Poses that are off by many pixels leave stereo little to see: they are refined on small images first, where they are
/// off by few.
std::vector<Camera> RefinedFromCoarse(const Run& run, std::vector<Camera> cameras) {
  PoseRefinementOptions options;
  options.gate = 0, options.enough = 1;
  for (const int reduction : {4, 2}) {
    const std::vector<LoadedView> views = SmallerViews(run, cameras, reduction);
    if (views.empty()) continue;
    const PoseRefinement refined = RefinePoses(views, StereoOf(run, views, "poses"), options);
    if (refined.result != PoseRefinementResult::kRefined) continue;
    for (size_t v = 0; v < cameras.size(); ++v) cameras[v].cam_from_world = refined.cameras[v].cam_from_world;
  }
  return cameras;
}

/// Whether what refinement left passes the usual gate.
bool Fits(const PoseRefinement& refined) {
  std::vector<double> views;
  for (const RefinedView& view : refined.views) views.push_back(view.residual.after);
  return PassesGate(refined.residual.after, views, PoseRefinementOptions().gate);
}

/// Whether COLMAP has bound the poses by more photos than stereo looks at: it adjusts them all, refinement only some.
bool AreOfManyPhotos(const Run& run, const std::vector<Camera>& cameras) {
  return !run.photos.empty() && !run.plan.poses && ViewsForStereo(cameras).size() < cameras.size();
}

/// The run with refined poses where its given ones are off, and stereo of the poses as they are then; empty where it
/// has to run again. Depth of wrong poses is wrong itself: stereo and refinement take turns.
PoseRefinement Refine(Run* run, std::vector<DepthMap>* stereo) {
  const std::vector<LoadedView>& views = ViewsOf(run).views;
  if (run->given) UsePoses(run, WorkingCameras(run->Given(), run->split.train, run->plan.image));
  const std::vector<Camera> given = CamerasOf(views);
  *stereo = StereoOf(*run, views, "poses");
  PoseRefinementOptions options;
  if (AreOfManyPhotos(*run, given)) options.gate = std::numeric_limits<double>::infinity();
  if (run->options.depth.refine_poses == PoseRefining::kOn) options.gate = 0;
  PoseRefinement first = RefinePoses(views, *stereo, options);
  if (first.result == PoseRefinementResult::kKept || first.result == PoseRefinementResult::kUnknown) return first;
  PoseRefinement refined = first;
  if (first.result == PoseRefinementResult::kUndone || !Fits(first)) {
    refined.cameras = RefinedFromCoarse(*run, given);
  }
  options.gate = 0, options.enough = 1;
  for (int i = 1; i < kMaxRefinements; ++i) {
    UsePoses(run, refined.cameras);
    *stereo = StereoOf(*run, views, "poses");
    const PoseRefinement more = RefinePoses(views, *stereo, options);
    const bool goes_on = more.result == PoseRefinementResult::kRefined;
    const auto left = goes_on ? &PoseResidual::after : &PoseResidual::before;
    for (size_t v = 0; v < views.size(); ++v) refined.views[v].residual.after = more.views[v].residual.*left;
    refined.residual.after = more.residual.*left;
    if (!goes_on) break;
    stereo->clear();  // is that of the poses before
    refined.cameras = more.cameras;
    if (Fits(more)) break;
  }
  const std::vector<CameraMovement> movements = Movements(given, refined.cameras);
  for (size_t v = 0; v < views.size(); ++v) refined.views[v].movement = movements[v];
  if (LeftShare(refined.views) < PoseRefinementOptions().enough && IsBelieved(movements)) {
    UsePoses(run, refined.cameras);
    refined.result = PoseRefinementResult::kRefined;
    return refined;
  }
  UsePoses(run, given);
  run->scene = std::move(*run->given);  // bit by bit
  run->given.reset();
  stereo->clear();
  first.result = PoseRefinementResult::kUndone;
  first.cameras = given;
  return first;
}

json RecordOf(const PoseRefinement& refinement) {
  json views = json::array();
  for (const RefinedView& view : refinement.views) {
    views.push_back({{"name", view.name},
                     {"before", view.residual.before},
                     {"after", view.residual.after},
                     {"degrees", view.movement.degrees},
                     {"share", view.movement.share}});
  }
  return {{"result", WordOf(refinement.result)}, {"before", refinement.residual.before},
          {"after", refinement.residual.after},  {"offsets", refinement.offsets},
          {"views", std::move(views)},           {"files", json::array()}};
}

/// The view with the largest of these numbers.
json WorstView(const json& record, const char* number) {
  const json views = record.value("views", json::array());
  if (views.empty()) return json::object();
  return *std::max_element(views.begin(), views.end(),
                           [&](const json& a, const json& b) { return a.value(number, 0.) < b.value(number, 0.); });
}

/// "off by 0.71 px, IMG_3.jpg by 1.57 px"
std::string OffBy(const json& record, const char* when) {
  const json worst = WorstView(record, when);
  return fmt::format("{:.2f} px, {} by {:.2f} px", record.value(when, 0.), worst.value("name", ""),
                     worst.value(when, 0.));
}

/// The warning about the poses that are used; "" where nothing is wrong with them.
std::string WarningOf(const json& record) {
  const std::string result = record.at("result");
  if (result == "undone") {
    return fmt::format(
        "poses are off by {}, and no small correction fixes them (the best would turn a camera by {:.1f} degrees and "
        "move one by {:.1f} % of the scene): they are kept as they are, and what they show may blur; find them anew "
        "from the photos alone",
        OffBy(record, "before"), WorstView(record, "degrees").value("degrees", 0.),
        100 * WorstView(record, "share").value("share", 0.));
  }
  if (result == "kept" && WorstView(record, "before").value("before", 0.) > kMaxLeft) {
    return fmt::format(
        "poses are off by {}, and are kept, for stereo looks at {} of the photos alone; what they show may blur: "
        "--refine-poses on refines them all the same",
        OffBy(record, "before"), kMaxStereoViews);
  }
  const json worst = WorstView(record, "after");
  if (result != "refined" || worst.value("after", 0.) <= kMaxLeft) return "";
  return fmt::format(
      "the pose of {} is still off by {:.2f} px, and what it shows may blur: leave the photo out, or find its pose "
      "anew",
      worst.value("name", ""), worst.value("after", 0.));
}

std::optional<json> MakePoses(Run* run, const std::string&) {
  std::vector<DepthMap> stereo;
  const PoseRefinement refinement = Refine(run, &stereo);
  json record = RecordOf(refinement);
  record["warning"] = WarningOf(record);
  if (refinement.result == PoseRefinementResult::kRefined) {
    WriteRefinedPoses(run->workspace.refined_poses(), NamesAt(run->scene, run->split.train), refinement.cameras);
    record["files"].push_back("sfm/refined.json");
  }
  run->results->stereo = std::move(stereo);
  return record;
}

bool LoadPoses(Run* run) {
  UseRefinedPoses(run);
  return true;
}

void ReportPoses(Run* run) {
  const json record = run->workspace.Record("poses");
  const std::string result = record.value("result", "");
  if (result == "unknown") {
    run->listener(Note{"poses: too few patches are common to the photos to say how well they fit"});
  } else if (result == "kept" && record.value("warning", "").empty()) {
    run->listener(Note{fmt::format("poses fit the photos within {}; they are kept", OffBy(record, "before"))});
  } else if (result == "refined") {
    run->listener(Note{fmt::format(
        "poses were off by {}, and are refined to {}: cameras turned by up to {:.2f} degrees and moved by up to "
        "{:.1f} % of the scene (--refine-poses off keeps them)",
        OffBy(record, "before"), OffBy(record, "after"), WorstView(record, "degrees").value("degrees", 0.),
        100 * WorstView(record, "share").value("share", 0.))});
  }
  if (const std::string warning = record.value("warning", ""); !warning.empty()) run->listener(Warning{warning});
}

std::string Summary(const json& record) {
  const std::string result = record.value("result", "");
  if (result == "unknown") return "not checked";
  if (result == "kept") return fmt::format("fit within {:.2f} px", record.value("before", 0.));
  return fmt::format("{}: {:.2f} px, were {:.2f} px", result, record.value("after", 0.), record.value("before", 0.));
}

}  // namespace

StageWork PosesStage() {
  return {.wanted = [](const Run& run) { return run.plan.refines_poses; },
          .own = AddPosesKey,
          .undo = UndoPoses,
          .make = MakePoses,
          .load = LoadPoses,
          .report = ReportPoses,
          .summary = Summary,
          .seconds =
              [](const EstimateInput& input) {
                constexpr double kOffsetsOfView = 0.1;
                return SecondsOfStereo(input) + kOffsetsOfView * input.scene.views;
              }};
}

}  // namespace oraclegs
