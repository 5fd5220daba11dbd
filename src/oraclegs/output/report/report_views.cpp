#include "oraclegs/output/report/report_views.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "oraclegs/core/interrupt.h"
#include "oraclegs/depth/silhouettes.h"
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
constexpr double kWellSupported = 0.85;  // share of a proposal's pixels; above it no photo is suggested
constexpr size_t kLargestAdvice = 3;

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
  explicit Renderer(const Model& of) : model(of), rasterizer(MakeRasterizer(of.gaussians.means.device())) {
    if (!of.marks.support.empty()) {
      tinted = Recolored(of.gaussians, SupportColors(of.marks.support));
      seen = Recolored(of.gaussians, SeenByTwo(of.marks.support));
    }
    if (of.others || !of.marks.uncertainty.empty())
      uncertain.emplace(of, std::vector{RenderValue::kUncertainty}, std::vector<Camera>());
    flat = of.render;
    flat.sh_degree = 0;
    flat.background = {0, 0, 0};
  }

  /// Colors that are white where two or more images support a Gaussian, black elsewhere.
  static Buffer<float> SeenByTwo(const std::vector<float>& support) {
    Buffer<float> colors = Buffer<float>::Zeros({static_cast<int64_t>(support.size()), 3});
    for (size_t i = 0; i < support.size(); ++i) {
      if (SupportClassOf(support[i]) == SupportClass::kSeenByTwo) std::fill_n(colors.data() + 3 * i, 3, 1.f);
    }
    return colors;
  }

  Image8 Colors(const Camera& camera) {
    return ToImage8(rasterizer->Forward(model.gaussians, camera, model.render, RenderPass::kInference).image);
  }
  std::optional<Image8> Support(const Camera& camera) {
    if (!tinted) return std::nullopt;
    return ToImage8(rasterizer->Forward(*tinted, camera, flat, RenderPass::kInference).image);
  }
  /// Share of the pixels that two or more images support; `of_object`: of those that the model covers.
  std::optional<double> SupportedShare(const Camera& camera, bool of_object) {
    if (!seen) return std::nullopt;
    const RenderOutput output = rasterizer->Forward(*seen, camera, flat, RenderPass::kInference);
    const double supported = MeanOf(ValuesOf(ToImage8(output.image)));
    if (!of_object) return supported;
    const Buffer<float> alpha = output.alpha.To(kCpu);
    const double covered = MeanOf({alpha.span().begin(), alpha.span().end()});
    return covered > 0 ? std::min(1., supported / covered) : 1;
  }

  const Model& model;
  std::unique_ptr<Rasterizer> rasterizer;
  std::optional<Gaussians> tinted, seen;
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
    if (const auto share = renderer_->SupportedShare(target.camera, of_object_)) {
      Seen seen{rows_.size(), {}, *share};
      for (size_t i = 0; i < std::min<size_t>(2, nearest.size()); ++i) seen.neighbors.push_back(names_[nearest[i]]);
      seen_.push_back(std::move(seen));
    }
  }
  rows_.push_back(std::move(row));
}

const nlohmann::json& ReportViews::Rows() const { return rows_; }

nlohmann::json ReportViews::Advice() const {
  std::vector<Seen> least = seen_;
  std::stable_sort(least.begin(), least.end(), [](const Seen& a, const Seen& b) { return a.supported < b.supported; });
  nlohmann::json advice = nlohmann::json::array();
  std::vector<std::vector<std::string>> places;
  for (const Seen& seen : least) {
    if (seen.supported >= kWellSupported || advice.size() == kLargestAdvice || seen.neighbors.empty()) break;
    const bool is_told = std::any_of(places.begin(), places.end(), [&](const std::vector<std::string>& place) {
      return place.front() == seen.neighbors.front() ||
             std::is_permutation(place.begin(), place.end(), seen.neighbors.begin(), seen.neighbors.end());
    });
    if (is_told) continue;
    places.push_back(seen.neighbors);
    const std::string where = seen.neighbors.size() == 1
                                  ? "near " + seen.neighbors[0]
                                  : fmt::format("near {}, toward {}", seen.neighbors[0], seen.neighbors[1]);
    advice.push_back(
        {{"text", fmt::format("Take a photo {}: two or more photos show only {:.0f} % of what is seen there.", where,
                              100 * seen.supported)},
         {"view", seen.row}});
  }
  if (advice.empty() && !least.empty()) {
    advice.push_back({{"text", fmt::format("You have enough photos: two or more of them show at least {:.0f} % of what "
                                           "is seen from every place that was tried.",
                                           100 * least.front().supported)},
                      {"view", nullptr}});
  }
  return advice;
}

}  // namespace oraclegs
