#include "oraclegs/sfm/tie_spheres.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>
#include <string>
#include <utility>

#include "oraclegs/camera/sphere_faces.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/statistics.h"
#include "oraclegs/scene/colmap_files.h"
#include "oraclegs/scene/read_colmap.h"
#include "oraclegs/sfm/colmap_database.h"
#include "oraclegs/sfm/colmap_runner.h"
#include "oraclegs/sfm/colmap_workspace.h"
#include "oraclegs/sfm/known_poses.h"
#include "oraclegs/sfm/retry_schedule.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr int kWeiszfeldSteps = 50;
constexpr double kLeastDistance = 1e-12;  // of a median to what it is of: weights stay finite

// Thresholds of points in pixels: the poses of the first round are medians, those of the second are adjusted.
constexpr double kRounds[] = {12, 4};
constexpr double kWeakShare = .1;  // of the points that spheres usually see

using Weights = std::vector<double>;

/// Weighted median: `ways(x)` lists the ways from x to each value, `add` goes one.
template <class Value, class Ways, class Add>
Value MedianOf(Value x, const Weights& of, const Ways& ways, const Add& add) {
  for (int i = 0; i < kWeiszfeldSteps; ++i) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double weights = 0;
    const std::vector<Eigen::Vector3d> to = ways(x);
    for (size_t k = 0; k < to.size(); ++k) {
      const double weight = of[k] / std::max(to[k].norm(), kLeastDistance);
      sum += weight * to[k];
      weights += weight;
    }
    x = add(x, sum / weights);
  }
  return x;
}

Eigen::Vector3d MedianCenter(const std::vector<Eigen::Vector3d>& centers, const Weights& weights) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (size_t i = 0; i < centers.size(); ++i) sum += weights[i] * centers[i];
  return MedianOf(
      Eigen::Vector3d(sum / std::accumulate(weights.begin(), weights.end(), 0.)), weights,
      [&](const Eigen::Vector3d& x) {
        std::vector<Eigen::Vector3d> ways;
        for (const Eigen::Vector3d& center : centers) ways.push_back(center - x);
        return ways;
      },
      [](const Eigen::Vector3d& x, const Eigen::Vector3d& way) { return Eigen::Vector3d(x + way); });
}

/// Ways are axes of rotations, as long as their angles.
Eigen::Matrix3d MedianRotation(const std::vector<Eigen::Matrix3d>& rotations, const Weights& weights) {
  const auto ways = [&](const Eigen::Matrix3d& x) {
    std::vector<Eigen::Vector3d> to;
    for (const Eigen::Matrix3d& rotation : rotations) {
      const Eigen::AngleAxisd turn(Eigen::Matrix3d(x.transpose() * rotation));
      to.push_back(turn.angle() * turn.axis());
    }
    return to;
  };
  const auto add = [](const Eigen::Matrix3d& x, const Eigen::Vector3d& way) {
    const double angle = way.norm();
    return angle > 0 ? Eigen::Matrix3d(x * Eigen::AngleAxisd(angle, way / angle)) : x;
  };
  // From the one that is nearest to all: far from the median the steps can end at another place.
  const auto farness = [&](const Eigen::Matrix3d& x) {
    const std::vector<Eigen::Vector3d> to = ways(x);
    double sum = 0;
    for (size_t k = 0; k < to.size(); ++k) sum += weights[k] * to[k].norm();
    return sum;
  };
  const auto start = std::min_element(rotations.begin(), rotations.end(),
                                      [&](const auto& a, const auto& b) { return farness(a) < farness(b); });
  return MedianOf(*start, weights, ways, add);
}

/// A face that is staged: where it lies in the database, and what it is.
struct StagedFace {
  std::string name;  ///< of the image below work_dir/images
  DatabaseImage stored;
  int face = 0;
  Intrinsics camera;
};

/// The staged faces of each sphere, by the sphere's name.
using StagedSpheres = std::map<std::string, std::vector<StagedFace>>;

StagedSpheres FindSpheres(const Scene& photos, const std::vector<int>& views, const std::vector<StagedView>& plan,
                          const fs::path& database) {
  StagedSpheres spheres;
  const auto is_face = [&](int v) { return photos.views[static_cast<size_t>(v)].sphere.has_value(); };
  if (std::none_of(views.begin(), views.end(), is_face)) return spheres;
  const auto stored = ReadDatabaseImages(database);
  for (size_t i = 0; i < plan.size(); ++i) {
    const SceneView& view = photos.views[static_cast<size_t>(views[i])];
    const auto found = stored.find(plan[i].name);
    if (!view.sphere || found == stored.end()) continue;
    const int side = view.intrinsics.width;
    const Intrinsics camera{CameraModel::kSimpleRadial, side, side, {view.focal_prior, side / 2.0, side / 2.0, 0}};
    spheres[view.sphere->name].push_back({plan[i].name, found->second, view.sphere->face, camera});
  }
  return spheres;
}

using ImageIds = std::set<uint32_t>;

/// How many points each image of a model saw, by its id.
std::map<uint32_t, double> PointsOfImages(const fs::path& model) {
  std::map<uint32_t, double> points;
  for (const ColmapPoint& point : ReadColmapPoints(model)) {
    for (const uint32_t image : point.image_ids) ++points[image];
  }
  return points;
}

/// A model of poses alone, by those in `model`: those of faces are tied. Without the images of `left_out`.
void WriteTiedPoses(const StagedSpheres& spheres, const fs::path& model, const ImageIds& left_out, const fs::path& to) {
  ColmapCameras cameras = ReadColmapCameras(model);
  std::map<std::string, ColmapImage> images;
  for (ColmapImage& image : ReadColmapImages(model)) images[image.name] = std::move(image);
  std::map<uint32_t, double> points = PointsOfImages(model);
  for (const auto& [name, faces] : spheres) {
    std::vector<FoundFace> found;
    for (const StagedFace& face : faces) {
      const auto image = images.find(face.name);
      if (image == images.end()) continue;
      found.push_back({SphereFaces()[static_cast<size_t>(face.face)].face_from_sphere, image->second.cam_from_world,
                       std::max(1., points[face.stored.image_id])});
    }
    if (found.empty()) continue;
    const Eigen::Isometry3d sphere = SpherePose(found);
    for (const StagedFace& face : faces) {
      const Eigen::Isometry3d turn(SphereFaces()[static_cast<size_t>(face.face)].face_from_sphere);
      cameras[face.stored.camera_id] = face.camera;
      images[face.name] = {face.stored.image_id, face.name, face.stored.camera_id, turn * sphere};
    }
  }
  std::vector<ColmapImage> list;
  for (auto& [name, image] : images) {
    if (left_out.count(image.id) == 0) list.push_back(std::move(image));
  }
  WriteColmapText(to, cameras, list);
}

/// Faces of a direction in which no sphere saw a point, as where all of them show sky: rig_bundle_adjuster of COLMAP
/// 3.8 crashes of them.
ImageIds BlindFaces(const StagedSpheres& spheres, const fs::path& model) {
  std::map<uint32_t, double> points = PointsOfImages(model), of_camera;
  for (const auto& [name, faces] : spheres) {
    for (const StagedFace& face : faces) of_camera[face.stored.camera_id] += points[face.stored.image_id];
  }
  ImageIds blind;
  for (const auto& [name, faces] : spheres) {
    for (const StagedFace& face : faces) {
      if (of_camera[face.stored.camera_id] == 0) blind.insert(face.stored.image_id);
    }
  }
  return blind;
}

/// Faces of spheres that are not registered, or saw so few points that they are misplaced.
ImageIds FacesOfWeakSpheres(const StagedSpheres& spheres, const fs::path& model) {
  std::map<uint32_t, double> points = PointsOfImages(model);
  std::map<std::string, double> of_sphere;
  for (const auto& [name, faces] : spheres) {
    for (const StagedFace& face : faces) of_sphere[name] += points[face.stored.image_id];
  }
  std::vector<double> counts;
  for (const auto& [name, count] : of_sphere) counts.push_back(count);
  const double usual = UpperMedian(counts);
  ImageIds weak;
  for (const auto& [name, faces] : spheres) {
    if (of_sphere[name] >= kWeakShare * usual) continue;
    for (const StagedFace& face : faces) weak.insert(face.stored.image_id);
  }
  return weak;
}

/// Writes the file from which rig_bundle_adjuster reads the cameras' turns; the faces of a sphere have one name behind
/// "cameraN/".
void WriteRigs(const StagedSpheres& spheres, const ImageIds& left_out, const fs::path& file) {
  std::map<uint32_t, const StagedFace*> cameras;
  for (const auto& [name, faces] : spheres) {
    for (const StagedFace& face : faces) {
      if (left_out.count(face.stored.image_id) == 0) cameras.emplace(face.stored.camera_id, &face);
    }
  }
  // Spheres of one size have one set of six cameras.
  std::map<int, nlohmann::json> rigs;
  std::map<int, Eigen::Matrix3d> references;  // the turn of each rig's first camera
  for (const auto& [id, face] : cameras) {
    const Eigen::Matrix3d& face_from_sphere = SphereFaces()[static_cast<size_t>(face->face)].face_from_sphere;
    nlohmann::json& rig = rigs[face->camera.width];
    if (references.emplace(face->camera.width, face_from_sphere).second) rig["ref_camera_id"] = id;
    const Eigen::Quaterniond turn(Eigen::Matrix3d(face_from_sphere * references[face->camera.width].transpose()));
    rig["cameras"].push_back({{"camera_id", id},
                              {"image_prefix", face->name.substr(0, face->name.find('/') + 1)},
                              {"rel_qvec", {turn.w(), turn.x(), turn.y(), turn.z()}},
                              {"rel_tvec", {0.0, 0.0, 0.0}}});
  }
  nlohmann::json list = nlohmann::json::array();
  for (auto& [side, rig] : rigs) list.push_back(std::move(rig));
  WriteFileAtomically(file, list.dump(1) + "\n");
}

}  // namespace

Eigen::Isometry3d SpherePose(const std::vector<FoundFace>& faces) {
  std::vector<Eigen::Vector3d> centers;
  std::vector<Eigen::Matrix3d> rotations;
  Weights weights;
  for (const FoundFace& face : faces) {
    const Eigen::Isometry3d sphere = Eigen::Isometry3d(face.face_from_sphere.transpose()) * face.cam_from_world;
    rotations.emplace_back(sphere.linear());
    weights.push_back(face.weight);
    centers.emplace_back(-(sphere.linear().transpose() * sphere.translation()));
  }
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::Quaterniond(MedianRotation(rotations, weights)).normalized().toRotationMatrix();
  pose.translation() = -(pose.linear() * MedianCenter(centers, weights));
  return pose;
}

bool TieSpheres(const Scene& photos, const std::vector<int>& views, const std::vector<StagedView>& plan,
                const fs::path& work_dir, const Listener& listener) {
  const ColmapRunner colmap(work_dir, listener, "register");
  const StagedSpheres spheres = FindSpheres(photos, views, plan, colmap.database());
  if (spheres.empty()) return false;
  const fs::path folder = AttemptsFolder(work_dir), kept = work_dir / "sparse" / "0", rigs = folder / "rigs.json";
  int made = 0;
  const auto make_folder = [&] {
    fs::path next = folder / fmt::format("tied{}", made++);
    MakeFolder(next);
    return next;
  };
  // A model with points by the poses of another one.
  const auto triangulate = [&](const fs::path& model, double max_error, const ImageIds& left_out) {
    const fs::path poses = make_folder();
    fs::path points = make_folder();
    WriteTiedPoses(spheres, model, left_out, poses);
    SetDatabaseCameras(colmap.database(), ReadColmapCameras(poses));
    TriangulateAtPoses(colmap, poses, points, {{"Mapper.filter_max_reproj_error", fmt::format("{}", max_error)}});
    return points;
  };
  // The model, and the faces that it lacks where its points place them.
  const auto register_missing = [&](const fs::path& model) {
    fs::path registered = make_folder();
    ColmapOptions options = RemainingImagesOptions();
    options["input_path"] = model.string();
    options["output_path"] = registered.string();
    options["Mapper.ba_refine_focal_length"] = options["Mapper.ba_refine_extra_params"] = "0";
    colmap.Run("image_registrator", options, "placing spheres again");
    return IsColmapModel(registered) ? registered : model;
  };
  fs::path model = kept;
  for (const double max_error : kRounds) {
    fs::path points = triangulate(model, max_error, {});
    if (const ImageIds weak = FacesOfWeakSpheres(spheres, points); !weak.empty()) {
      model = register_missing(triangulate(model, max_error, weak));
      points = triangulate(model, max_error, {});
    }
    const ImageIds blind = BlindFaces(spheres, points);
    if (!blind.empty()) points = triangulate(model, max_error, blind);
    WriteRigs(spheres, blind, rigs);
    const fs::path adjusted = make_folder();
    try {
      colmap.AdjustRigs(points, rigs, adjusted);
    } catch (const ColmapFailure&) {  // newer versions have another command
    }
    if (!IsColmapModel(adjusted)) break;
    model = adjusted;
  }
  fs::path tied = triangulate(model, kRounds[1], {});
  const ImageIds weak = FacesOfWeakSpheres(spheres, tied);
  MoveTo(weak.empty() ? tied : triangulate(model, kRounds[1], weak), kept);
  RemoveAttempts(work_dir);
  return true;
}

}  // namespace oraclegs
