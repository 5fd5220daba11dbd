#include "oraclegs/sfm/pose_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

constexpr size_t kExamplesOfOrder = 3;
constexpr double kFarOff = 5;  // limits: no small error any more

/// Change that was tried, and what to do where it is right.
struct MistakeWords {
  std::string with, fix;
};

Eigen::Matrix3d Signs(double x, double y, double z) { return Eigen::Vector3d(x, y, z).asDiagonal(); }

/// A matrix that turns the picture by 90 degrees times `quarters` counterclockwise, as people see it.
Eigen::Matrix3d QuarterTurns(int quarters) {
  const std::array<double, 4> cosines{1, 0, -1, 0}, sines{0, 1, 0, -1};
  const double c = cosines[static_cast<size_t>(quarters)], s = sines[static_cast<size_t>(quarters)];
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() << c, s, -s, c;  // y points down
  return turn;
}

/// "-y, x, z": which of the given axes are right, down and forward.
std::string AxisNames(const Eigen::Matrix3d& axes) {
  std::string text;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      if (axes(row, column) == 0) continue;
      text += fmt::format("{}{}{}", row > 0 ? ", " : "", axes(row, column) < 0 ? "-" : "", "xyz"[column]);
    }
  }
  return text;
}

MistakeWords InverseWords(const Eigen::Matrix3d& axes, bool is_colmap) {
  const Eigen::Matrix3d flipped = Signs(1, -1, -1);
  if (is_colmap) {
    const std::string fix = "images.txt and images.bin hold world-to-camera poses; invert each";
    if (axes == Eigen::Matrix3d::Identity()) return {"with the poses inverted", fix};
    return {"with the poses inverted and other axes", fix + ", then export in COLMAP's axes (y down, z forward)"};
  }
  const std::string fix = "transform_matrix is camera-to-world; invert each";
  if (axes == flipped) return {"with the matrices inverted", fix};
  return {"with the matrices inverted and the axes of OpenCV",
          fix + ", then negate its second and third columns (the axes are those of OpenGL: y up, z back)"};
}

MistakeWords AxesWords(const Eigen::Matrix3d& axes, bool is_colmap) {
  if (axes == Signs(1, -1, -1)) {
    if (is_colmap) return {"with the axes of OpenGL", "export the poses in COLMAP's axes (y down, z forward)"};
    return {"with the axes of OpenCV",
            "negate the second and third columns of each transform_matrix, whose axes are those of OpenGL (y up, z "
            "back)"};
  }
  for (int quarters = 1; quarters < 4; ++quarters) {
    if (axes != QuarterTurns(quarters)) continue;
    const int degrees = quarters == 2 ? 180 : 90;
    return {fmt::format("with the photos turned by {} degrees", degrees),
            fmt::format("the poses are those of photos that stand otherwise: turn each by {} degrees{}, or correct the "
                        "EXIF orientation",
                        degrees,
                        quarters == 2   ? ""
                        : quarters == 1 ? " clockwise"
                                        : " counterclockwise")};
  }
  if (axes == Signs(-1, 1, 1) || axes == Signs(1, -1, 1)) {
    return {fmt::format("with the photos mirrored {}", axes(0, 0) < 0 ? "left to right" : "top to bottom"),
            "mirror them back, or export poses of right-handed axes"};
  }
  if (axes.determinant() < 0) {
    return {fmt::format("with mirrored axes ({} right, down and forward)", AxisNames(axes)),
            "the poses are left-handed, as those of Unity and Unreal; export right-handed ones"};
  }
  return {fmt::format("with other axes ({} right, down and forward)", AxisNames(axes)),
          "export the poses in the axes of this format"};
}

MistakeWords FocalWords(const CameraChange& change, bool is_colmap) {
  const std::string names = is_colmap ? "the focal length" : "fl_x, fl_y (or camera_angle_x)";
  if (change.is_other_resolution) {
    return {fmt::format("with the cameras of photos {:.2f} times as large", change.focal_factor),
            fmt::format("the cameras are those of another resolution: multiply focal lengths and principal point by "
                        "{:.3g}",
                        change.focal_factor)};
  }
  return {fmt::format("with a focal length {:.2f} times as long", change.focal_factor),
          fmt::format("check {}: the photos ask for {:.3g} times the value", names, change.focal_factor)};
}

MistakeWords OrderWords(const Scene& scene, const PoseFit& fit) {
  std::vector<std::string> examples;
  for (size_t i = 0; i < fit.views.size() && examples.size() < kExamplesOfOrder; ++i) {
    const std::string& pose_of = scene.views[static_cast<size_t>(fit.order->pose_of_view[i])].name;
    if (pose_of != fit.views[i].name) examples.push_back(fmt::format("{} has that of {}", pose_of, fit.views[i].name));
  }
  std::string words = "with the photos in another order";
  if (!fit.order->words.empty()) words += fmt::format(" ({})", fit.order->words);
  return {words, fmt::format("give each photo its own pose: {}", fmt::join(examples, ", "))};
}

MistakeWords TurnedWords(const PoseFit& fit) {
  std::vector<std::string> names;
  for (const int view : fit.turned->views) names.push_back(fit.views[static_cast<size_t>(view)].name);
  return {fmt::format("with {} turned by 180 degrees", SomeNames(names)),
          "these photos stand upside down against their poses: turn them, or correct their EXIF orientation"};
}

std::optional<MistakeWords> WordsOf(const Scene& scene, const PoseFit& fit, double* share) {
  const bool is_colmap = scene.format == SceneFormat::kColmap;
  if (fit.order) {
    *share = fit.order->share;
    return OrderWords(scene, fit);
  }
  if (fit.turned) {
    *share = fit.turned->share;
    return TurnedWords(fit);
  }
  if (!fit.change) return std::nullopt;
  *share = fit.change->share;
  const CameraChange& change = fit.change->change;
  if (change.focal_factor != 1) return FocalWords(change, is_colmap);
  return change.inverse ? InverseWords(change.axes, is_colmap) : AxesWords(change.axes, is_colmap);
}

/// "by 2.3 pixels", of the photos.
std::string ErrorWords(const FitOfView& view) {
  const double pixels = view.ErrorInPhoto();
  return std::isfinite(pixels) ? fmt::format("{:.{}f} pixels", pixels, pixels < 10 ? 1 : 0) : "more than can be said";
}

std::string WorstViews(const PoseFit& fit) {
  std::vector<std::string> names;
  for (const std::string& name : fit.NamesOff()) {
    const auto view = std::find_if(fit.views.begin(), fit.views.end(), [&](const auto& v) { return v.name == name; });
    names.push_back(fmt::format("{} ({})", name, std::isfinite(view->error) ? ErrorWords(*view) : "nothing fits"));
  }
  return SomeNames(names);
}

/// The folder that all photos lie in; "" where there are several.
std::string PhotoFolder(const Scene& scene) {
  std::filesystem::path folder;
  for (const SceneView& view : scene.views) {
    const std::filesystem::path own = view.image_path.parent_path().lexically_normal();
    if (!folder.empty() && own != folder) return "";
    folder = own;
  }
  return folder.empty() ? "" : " (" + folder.string() + ")";
}

std::string NextStep(const Scene& scene) {
  return fmt::format(
      "take the poses from the program that aligned these very photos, or have them found: name the folder of the "
      "photos alone{}",
      PhotoFolder(scene));
}

const char* VerdictWord(PoseVerdict verdict) {
  switch (verdict) {
    case PoseVerdict::kUnknown:
      return "unknown";
    case PoseVerdict::kFit:
      return "fit";
    case PoseVerdict::kOff:
      return "off";
    case PoseVerdict::kHopeless:
      return "hopeless";
  }
  return "unknown";
}

nlohmann::json FitToJson(const FitOfView& view) {
  const double pixels = view.ErrorInPhoto();
  return {{"matches", view.matches},
          {"error_pixels", std::isfinite(pixels) ? nlohmann::json(pixels) : nlohmann::json()},
          {"share", view.share}};
}

}  // namespace

std::string DescribeMisfit(const Scene& scene, const PoseFit& fit) {
  if (fit.verdict == PoseVerdict::kUnknown || fit.verdict == PoseVerdict::kFit) return "";
  const FitOfView& all = fit.all;
  const std::string fits = fmt::format("{:.0f} % of {} between them fit", 100 * all.share,
                                       Counted(all.matches, all.matches == 1 ? "match" : "matche"));
  double share = 0;
  if (const auto mistake = WordsOf(scene, fit, &share)) {
    return fmt::format("the given poses do not fit the photos: {}; {} {:.0f} % of the matches fit: {}", fits,
                       mistake->with, 100 * share, mistake->fix);
  }
  if (fit.verdict == PoseVerdict::kHopeless || all.error > kFarOff * all.limit) {
    return fmt::format("the given poses do not fit the photos: {}, and no usual mistake explains it; {}", fits,
                       NextStep(scene));
  }
  const std::string worst = WorstViews(fit);
  if (!all.IsOff()) {
    return fmt::format("the given poses of {} do not fit the other photos; what they show will be blurred: {}", worst,
                       NextStep(scene));
  }
  return fmt::format(
      "the given poses are a little wrong: half of the points that two photos show miss them by more than {} ({}){}; "
      "the splat will be blurred: {}",
      ErrorWords(all), fits, worst.empty() ? "" : ", most in " + worst, NextStep(scene));
}

nlohmann::json ToJson(const PoseFit& fit) {
  nlohmann::json json = FitToJson(fit.all);
  json["verdict"] = VerdictWord(fit.verdict);
  json["views"] = nlohmann::json::array();
  for (const FitOfView& view : fit.views) {
    json["views"].push_back(FitToJson(view));
    json["views"].back()["name"] = view.name;
  }
  return json;
}

}  // namespace oraclegs
