#include "oraclegs/output/report/report_views.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "oraclegs/core/interrupt.h"
#include "oraclegs/depth/silhouettes.h"
#include "oraclegs/evaluate/pixel_errors.h"
#include "oraclegs/evaluate/uncertainty.h"
#include "oraclegs/image/colormap.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/output/report/value_images.h"
#include "oraclegs/propose/nearest_order.h"
#include "oraclegs/propose/proposal_files.h"
#include "oraclegs/render/recolor.h"
#include "oraclegs/render/render.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr size_t kReportedProposals = 32;
constexpr size_t kTriedSpares = 48;
constexpr size_t kLargestAdvice = 3;
constexpr double kMuchLessSure = 1.5;  // the error to expect at a place over that at the photos
constexpr int kSideOfPlaces = 160;     // px, the longer side of images that only a mean is taken of

/// Colors of the values, which are width * height.
Image8 InColors(const std::vector<float>& values, int width, int height) {
  Image8 image{width, height, 3, {}};
  image.data.reserve(3 * values.size());
  for (const float value : values) {
    const auto color = MapColor(ColorMap::kPlasma, value);
    image.data.insert(image.data.end(), color.begin(), color.end());
  }
  return image;
}

/// Mean absolute difference over the channels, divided by kLargestShownError.
std::vector<float> ErrorsOf(const Image8& render, const Image8& truth) {
  std::vector<float> errors(render.data.size() / 3);
  for (size_t p = 0; p < errors.size(); ++p) {
    int sum = 0;
    for (size_t c = 0; c < 3; ++c) sum += std::abs(render.data[3 * p + c] - truth.data[3 * p + c]);
    errors[p] = static_cast<float>(sum) / (3 * 255 * kLargestShownError);
  }
  return errors;
}

/// Values in [0, 1] of a gray map.
std::vector<float> ValuesOf(const Image8& map) {
  std::vector<float> values;
  for (size_t i = 0; i < map.data.size(); i += static_cast<size_t>(map.channels)) {
    values.push_back(static_cast<float>(map.data[i]) / 255);
  }
  return values;
}

double MeanOf(const std::vector<float>& values) {
  double sum = 0;
  for (const float value : values) sum += value;
  return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

/// Indices of the cameras by their distance from this one; a rotation by one radian counts as their mean distance.
std::vector<size_t> ByDistance(const Camera& from, const std::vector<Camera>& cameras) {
  std::vector<double> distance;
  double unit = 0;
  for (const Camera& camera : cameras) {
    unit += (camera.Center() - from.Center()).norm() / static_cast<double>(cameras.size());
  }
  for (const Camera& camera : cameras) {
    distance.push_back((camera.Center() - from.Center()).norm() + unit * TurnBetween(camera, from));
  }
  std::vector<size_t> order(cameras.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return distance[a] < distance[b]; });
  return order;
}

}  // namespace

/// Renders the model in its own colors and in the colors of its support.
struct ReportViews::Renderer {
  explicit Renderer(const Model& of)
      : model(of),
        rasterizer(MakeRasterizer(of.gaussians.means.device())),
        errors(of.gaussians, of.others.value_or(std::vector<Gaussians>()), of.render) {
    if (!of.marks.support.empty()) tinted = Recolored(of.gaussians, SupportColors(of.marks.support));
    if (of.others || !of.marks.uncertainty.empty())
      uncertain.emplace(of, std::vector{RenderValue::kUncertainty}, std::vector<Camera>());
    flat = of.render;
    flat.sh_degree = 0;
    flat.background = {0, 0, 0};
  }

  Image8 Colors(const Camera& camera) {
    return ToImage8(rasterizer->Forward(model.gaussians, camera, model.render, RenderPass::kInference).image);
  }
  std::optional<Image8> Support(const Camera& camera) {
    if (!tinted) return std::nullopt;
    return ToImage8(rasterizer->Forward(*tinted, camera, flat, RenderPass::kInference).image);
  }
  /// Mean error to expect of what is seen from there. A hole in a scene is as wrong as an error that is shown can be;
  /// what surrounds an object does not count.
  double ExpectedError(const Camera& camera, bool of_object) {
    const double scale = std::min(1., static_cast<double>(kSideOfPlaces) / std::max(camera.width, camera.height));
    const Camera small = Resized(camera, std::max(1, static_cast<int>(std::lround(scale * camera.width))),
                                 std::max(1, static_cast<int>(std::lround(scale * camera.height))));
    const Buffer<float> alpha =
        rasterizer->Forward(model.gaussians, small, model.render, RenderPass::kInference).alpha.To(kCpu).Clone();
    const std::vector<float> expected = errors.At(small);
    std::vector<float> counted;
    for (size_t p = 0; p < expected.size(); ++p) {
      const bool is_hole = alpha[static_cast<int64_t>(p)] < kDrawnAlpha;
      if (!is_hole || !of_object) counted.push_back(is_hole ? std::max(expected[p], kLargestShownError) : expected[p]);
    }
    return MeanOf(counted);
  }

  const Model& model;
  std::unique_ptr<Rasterizer> rasterizer;
  Uncertainty errors;
  std::optional<Gaussians> tinted;
  std::optional<ValueRenderer> uncertain;
  RenderOptions flat;
};

nlohmann::json CameraToJson(const Camera& camera) {
  std::vector<double> matrix;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) matrix.push_back(camera.cam_from_world.matrix()(row, column));
  }
  return {{"width", camera.width}, {"height", camera.height}, {"fx", camera.fx},          {"fy", camera.fy},
          {"cx", camera.cx},       {"cy", camera.cy},         {"world_to_camera", matrix}};
}

ReportViews::ReportViews(const Run& run, const ReportFiles& files, const Model* model)
    : run_(run), files_(files), rows_(nlohmann::json::array()) {
  if (model != nullptr) renderer_ = std::make_unique<Renderer>(*model);
}

ReportViews::~ReportViews() = default;

nlohmann::json ReportViews::Row(const std::string& name, const char* role, const Image8& image) {
  const std::string stem = fmt::format("{}_{}", role, rows_.size());
  return {{"id", rows_.size()},
          {"name", name},
          {"role", role},
          {"image", files_.Image(stem, image)},
          {"thumbnail", files_.Thumbnail(stem + "_small", image)}};
}

void ReportViews::AddPhoto(const std::string& name, const Image8& image) {
  ThrowIfInterrupted();
  rows_.push_back(Row(name, "train", image));
}

void ReportViews::AddTraining(const LoadedView& view) {
  ThrowIfInterrupted();
  nlohmann::json row = Row(view.name, "train", ToImage8(view.rgb));
  row["camera"] = CameraToJson(view.camera);
  if (renderer_) {
    row["render"] = files_.Image(fmt::format("train_{}_render", rows_.size()), renderer_->Colors(view.camera));
  }
  rows_.push_back(std::move(row));
  names_.push_back(view.name);
  cameras_.push_back(view.camera);
  of_object_ = of_object_ || !view.alpha.empty() || !Silhouettes({view}).empty();
}

void ReportViews::AddTest(const LoadedView& view) {
  if (!renderer_) return;
  ThrowIfInterrupted();
  const std::string stem = fmt::format("test_{}", rows_.size());
  const Image8 truth = ToImage8(view.rgb), render = renderer_->Colors(view.camera);
  std::vector<float> errors = ErrorsOf(render, truth);
  for (size_t p = 0; p < view.mask.size(); ++p)
    errors[p] = view.mask[p] == 0 ? 0 : errors[p];  // masked pixels have no error, as in the scores
  nlohmann::json row = Row(view.name, "test", truth);
  row["camera"] = CameraToJson(view.camera);
  row["render"] = files_.Image(stem + "_render", render);
  row["error"] = files_.Image(stem + "_error", InColors(errors, truth.width, truth.height));
  if (const auto support = renderer_->Support(view.camera)) row["support"] = files_.Image(stem + "_support", *support);
  if (renderer_->uncertain) {
    row["uncertainty"] = files_.Image(stem + "_uncertainty", renderer_->uncertain->Render(view.camera).front());
  }
  rows_.push_back(std::move(row));
}

void ReportViews::AddProposals() {
  const WorkspacePaths& paths = run_.workspace;
  std::error_code ignored;
  const bool has_own_poses = fs::exists(paths.confidence() / "transforms.json", ignored);
  const fs::path poses = has_own_poses ? paths.confidence() : paths.proposals();
  if (!fs::exists(poses / "transforms.json", ignored)) return;
  try {
    std::vector<Target> targets = ReadTargets(poses);
    for (Target& target : targets) {
      target.camera.cam_from_world = Moved(target.camera.cam_from_world, RunFromScene(run_.frame));
    }
    std::erase_if(targets,
                  [&](const Target& t) { return !fs::exists(paths.proposals() / (t.name + ".png"), ignored); });
    for (const Target& target : Evenly(targets, kReportedProposals)) AddProposal(target);
  } catch (const InputError& damage) {  // a report is no reason to make proposals again
    run_.listener(Warning{fmt::format("{}; the report lacks invented views", damage.what())});
  }
}

void ReportViews::AddProposal(const Target& target) {
  ThrowIfInterrupted();
  std::error_code ignored;
  const std::string stem = fmt::format("proposal_{}", rows_.size()), file = target.name + ".png";
  nlohmann::json row = Row(target.name, "proposal", ReadImage(run_.workspace.proposals() / file));
  row["camera"] = CameraToJson(target.camera);
  const fs::path map = run_.workspace.confidence() / file;
  if (fs::exists(map, ignored)) {
    const Image8 gray = ReadImage(map);
    const std::vector<float> confidence = ValuesOf(gray);
    row["confidence"] = files_.Image(stem + "_confidence", InColors(confidence, gray.width, gray.height));
    row["mean_confidence"] = MeanOf(confidence);
  }
  const std::vector<size_t> nearest = ByDistance(target.camera, cameras_);
  if (!nearest.empty()) row["nearest"] = nearest.front();
  if (renderer_) {
    row["render"] = files_.Image(stem + "_render", renderer_->Colors(target.camera));
    places_.push_back({target.camera, rows_.size(), "", renderer_->ExpectedError(target.camera, of_object_)});
  }
  rows_.push_back(std::move(row));
}

const nlohmann::json& ReportViews::Rows() const { return rows_; }

void ReportViews::AddSpares() {
  if (!renderer_) return;
  std::vector<int> spares;
  for (int v = 0; v < static_cast<int>(run_.scene.views.size()); ++v) {
    const auto is_in = [v](const std::vector<int>& list) {
      return std::find(list.begin(), list.end(), v) != list.end();
    };
    if (run_.scene.views[static_cast<size_t>(v)].cam_from_world && !is_in(run_.split.train) &&
        !is_in(run_.split.test)) {
      spares.push_back(v);
    }
  }
  spares = Evenly(spares, kTriedSpares);
  const std::vector<Camera> cameras = WorkingCameras(run_.scene, spares, run_.plan.image);
  for (size_t i = 0; i < spares.size(); ++i) {
    ThrowIfInterrupted();
    const std::string& name = run_.scene.views[static_cast<size_t>(spares[i])].name;
    places_.push_back({cameras[i], std::nullopt, name, renderer_->ExpectedError(cameras[i], of_object_)});
  }
}

nlohmann::json ReportViews::Advice() {
  if (places_.empty() || cameras_.empty()) return nlohmann::json::array();
  double at_photos = 0;
  for (const Camera& camera : cameras_) {
    at_photos += renderer_->ExpectedError(camera, of_object_) / static_cast<double>(cameras_.size());
  }
  if (!(at_photos > 0)) return nlohmann::json::array();  // an object of which nothing is drawn
  std::stable_sort(places_.begin(), places_.end(), [](const Place& a, const Place& b) { return a.error > b.error; });
  nlohmann::json advice = nlohmann::json::array();
  std::vector<std::vector<size_t>> advised;
  for (Place& place : places_) {
    if (place.error < kMuchLessSure * at_photos || advice.size() == kLargestAdvice) break;
    std::vector<size_t> nearest = ByDistance(place.camera, cameras_);
    nearest.resize(std::min<size_t>(2, nearest.size()));
    const bool is_said = std::any_of(advised.begin(), advised.end(), [&](const std::vector<size_t>& other) {
      return other.front() == nearest.front() ||
             std::is_permutation(other.begin(), other.end(), nearest.begin(), nearest.end());
    });
    if (is_said) continue;
    const std::string near = names_[nearest.front()];
    const std::string what = !place.photo.empty() ? fmt::format("Use {}, too", place.photo)
                             : nearest.size() == 1
                                 ? fmt::format("Take a photo near {}", near)
                                 : fmt::format("Take a photo near {}, toward {}", near, names_[nearest[1]]);
    if (!place.row) {
      place.row = rows_.size();
      nlohmann::json row = Row(place.photo, "spare", renderer_->Colors(place.camera));
      row["camera"] = CameraToJson(place.camera);
      row["render"] = row["image"];
      rows_.push_back(std::move(row));
    }
    advised.push_back(std::move(nearest));
    advice.push_back(
        {{"text", fmt::format("{}: what is seen from there is {:.1f} times as unsure as what your photos show.", what,
                              place.error / at_photos)},
         {"view", *place.row}});
  }
  if (advice.empty()) {
    advice.push_back(
        {{"text",
          "You have enough photos of what they show: from every place that was tried, between and around them, the "
          "splat is about as sure as where they were taken. What none of them shows needs others."},
         {"view", nullptr}});
  }
  return advice;
}

}  // namespace oraclegs
