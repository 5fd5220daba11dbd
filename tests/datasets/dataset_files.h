#pragma once
// Cameras in the files of other programs, as those write them.

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "oraclegs/formats/zip_archive.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// A .npy of these bytes; `type` and `order` as NumPy writes them.
inline std::string NpyOf(const std::string& shape, std::string_view data, const char* type = "<f8",
                         const char* order = "False") {
  std::string header = fmt::format("{{'descr': '{}', 'fortran_order': {}, 'shape': {}, }}", type, order, shape);
  header.resize((header.size() + 10) / 64 * 64 + 63 - 10, ' ');
  header += '\n';
  std::string npy = "\x93NUMPY";
  npy += {'\1', '\0', static_cast<char>(header.size() & 255), static_cast<char>(header.size() >> 8)};
  return npy.append(header).append(data);
}

inline std::string NpyOf(const std::string& shape, const std::vector<double>& values) {
  return NpyOf(shape, std::string_view(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double)));
}

/// poses_bounds.npy, of images that are `factor` times as large.
inline std::string LlffFile(const std::vector<SceneView>& views, int factor = 1) {
  std::vector<double> rows;
  for (const SceneView& view : views) {
    const Eigen::Isometry3d world_from_cam = view.cam_from_world->inverse();
    const Eigen::Matrix3d r = world_from_cam.linear();
    const Eigen::Vector3d last =
        factor * Eigen::Vector3d(view.intrinsics.height, view.intrinsics.width, view.intrinsics.fx());
    for (int i = 0; i < 3; ++i) {
      for (const double x : {r(i, 1), r(i, 0), -r(i, 2), world_from_cam.translation()(i), last(i)}) rows.push_back(x);
    }
    rows.insert(rows.end(), {0.5, 20.0});
  }
  return NpyOf(fmt::format("({}, 17)", views.size()), rows);
}

inline Eigen::Matrix3d MatrixOf(const Intrinsics& intrinsics) {
  Eigen::Matrix3d k;
  k << intrinsics.fx(), 0, intrinsics.cx(), 0, intrinsics.fy(), intrinsics.cy(), 0, 0, 1;
  return k;
}

/// cameras_sphere.npz, of a world that is moved and enlarged; `factor` times the projections.
inline std::string NeusFile(const std::vector<SceneView>& views, double factor = 1) {
  std::vector<std::pair<std::string, std::string>> members;
  Eigen::Matrix4d scale = Eigen::Vector4d(3, 3, 3, 1).asDiagonal();
  scale.topRightCorner<3, 1>() = Eigen::Vector3d(10, -4, 2);
  const auto add = [&](const std::string& name, const Eigen::Matrix4d& matrix) {
    const Eigen::Matrix4d rows = matrix.transpose();
    members.emplace_back(name + ".npy", NpyOf("(4, 4)", std::vector<double>(rows.data(), rows.data() + 16)));
  };
  for (size_t i = 0; i < views.size(); ++i) {
    Eigen::Matrix4d projection = Eigen::Matrix4d::Identity();
    projection.topLeftCorner<3, 3>() = MatrixOf(views[i].intrinsics);
    add(fmt::format("world_mat_{}", i), factor * projection * views[i].cam_from_world->matrix() * scale.inverse());
    add(fmt::format("scale_mat_{}", i), scale);
  }
  return WriteZip(members);
}

/// bundle.out; the points need no pixels.
inline std::string BundleFile(const std::vector<SceneView>& views, const std::vector<ScenePoint>& points = {},
                              double k1 = 0, double k2 = 0) {
  std::string text = fmt::format("# Bundle file v0.3\n{} {}\n", views.size(), points.size());
  const Eigen::DiagonalMatrix<double, 3> flip(1, -1, -1);
  for (const SceneView& view : views) {
    const Eigen::Matrix3d r = flip * view.cam_from_world->linear();
    const Eigen::Vector3d t = flip * view.cam_from_world->translation();
    text += fmt::format("{} {} {}\n", view.intrinsics.fx(), k1, k2);
    for (int i = 0; i < 3; ++i) text += fmt::format("{} {} {}\n", r(i, 0), r(i, 1), r(i, 2));
    text += fmt::format("{} {} {}\n", t(0), t(1), t(2));
  }
  for (const ScenePoint& point : points) {
    text += fmt::format("{} {} {}\n{} {} {}\n{}", point.xyz(0), point.xyz(1), point.xyz(2), point.rgb[0], point.rgb[1],
                        point.rgb[2], point.views.size());
    for (const int view : point.views) text += fmt::format(" {} 7 1.5 -2.5", view);
    text += '\n';
  }
  return text;
}

/// list.txt as Bundler's own script writes it.
inline std::string BundleList(const std::vector<SceneView>& views) {
  std::string text;
  for (const SceneView& view : views) text += fmt::format("./{} 0 {}\n", view.name, view.intrinsics.fx());
  return text;
}

inline std::string NumbersOfMatrix(const Eigen::MatrixXd& matrix) {
  std::string text;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) text += fmt::format("{}{}", text.empty() ? "" : " ", matrix(i, j));
  }
  return text;
}

/// Where Metashape's chunk lies in the world of the cameras.
struct MetashapePlace {
  double angle = 0.4, scale = 2.5;  ///< turned about x
  Eigen::Vector3d translation{100, -20, 3};
};

/// cameras.xml with one sensor, whose calibration ends in `coefficients`; labels have no extension.
inline std::string MetashapeXml(const std::vector<SceneView>& views, const std::string& coefficients = "",
                                const MetashapePlace& place = {}) {
  const Intrinsics& lens = views.front().intrinsics;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(place.angle, Eigen::Vector3d::UnitX()).toRotationMatrix();
  std::string text = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<document version=\"2.0.0\">\n <chunk label=\"Chunk 1\" "
      "enabled=\"true\">\n  <sensors next_id=\"1\">\n   <sensor id=\"0\" label=\"unknown\" type=\"frame\">\n    "
      "<resolution width=\"{0}\" height=\"{1}\"/>\n    <calibration type=\"frame\" class=\"adjusted\">\n     "
      "<resolution width=\"{0}\" height=\"{1}\"/>\n     <f>{2}</f>\n     <cx>{3}</cx>\n     <cy>{4}</cy>\n{5}    "
      "</calibration>\n   </sensor>\n  </sensors>\n  <components next_id=\"1\" active_id=\"0\">\n   <component "
      "id=\"0\" "
      "label=\"Component 1\">\n    <transform>\n     <rotation>{6}</rotation>\n     <translation>{7}</translation>\n   "
      "  "
      "<scale>{8}</scale>\n    </transform>\n   </component>\n  </components>\n  <cameras next_id=\"9\">\n",
      lens.width, lens.height, lens.fy(), lens.cx() - lens.width / 2.0, lens.cy() - lens.height / 2.0, coefficients,
      NumbersOfMatrix(turn), NumbersOfMatrix(place.translation.transpose()), place.scale);
  for (size_t i = 0; i < views.size(); ++i) {
    const Eigen::Isometry3d world_from_cam = views[i].cam_from_world->inverse();
    Eigen::Matrix4d chunk_from_cam = Eigen::Matrix4d::Identity();
    chunk_from_cam.topLeftCorner<3, 3>() = turn.transpose() * world_from_cam.linear();
    chunk_from_cam.topRightCorner<3, 1>() =
        turn.transpose() * (world_from_cam.translation() - place.translation) / place.scale;
    text += fmt::format(
        "   <camera id=\"{}\" sensor_id=\"0\" component_id=\"0\" label=\"{}\">\n    <transform>{}</transform>\n   "
        "</camera>\n",
        i, std::filesystem::path(views[i].name).stem().string(), NumbersOfMatrix(chunk_from_cam));
  }
  return text + "  </cameras>\n </chunk>\n</document>\n";
}

/// The CSV of RealityScan.
inline std::string RealityScanCsv(const std::vector<SceneView>& views,
                                  const std::string& coefficients = "0,0,0,0,0,0") {
  std::string text = "#name,x,y,alt,heading,pitch,roll,f,px,py,k1,k2,k3,k4,t1,t2\r\n";
  const Eigen::DiagonalMatrix<double, 3> flip(1, -1, -1);
  for (const SceneView& view : views) {
    const Eigen::Isometry3d world_from_cam = view.cam_from_world->inverse();
    const Eigen::Matrix3d m = world_from_cam.linear() * flip;  // Rz(-heading) Rx(pitch) Ry(roll)
    const double degree = std::numbers::pi / 180, heading = std::atan2(m(0, 1), m(1, 1)) / degree;
    const double pitch = std::asin(std::clamp(m(2, 1), -1.0, 1.0)) / degree,
                 roll = std::atan2(-m(2, 0), m(2, 2)) / degree;
    const Intrinsics& lens = view.intrinsics;
    const double longer = std::max(lens.width, lens.height);
    text +=
        fmt::format("{},{},{},{},{},{},{},{},{},{},{}\r\n", std::filesystem::path(view.name).filename().string(),
                    world_from_cam.translation()(0), world_from_cam.translation()(1), world_from_cam.translation()(2),
                    heading, pitch, roll, lens.fx() / longer * 36, (lens.cx() - lens.width / 2.0) / longer,
                    (lens.cy() - lens.height / 2.0) / longer, coefficients);
  }
  return text;
}

}  // namespace oraclegs
