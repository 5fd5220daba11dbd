#include "oraclegs/stages/refined_poses.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/depth/pose_movement.h"

namespace oraclegs {
namespace {

using nlohmann::json;

constexpr double kTurns = 1e-6;  // largest difference of a rotation from one

json ToJson(const Eigen::Isometry3d& pose) {
  json rows = json::array();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 4; ++c) rows.push_back(pose(r, c));
  }
  return rows;
}

/// Throws json::exception or InputError for anything but 12 numbers of a pose.
Eigen::Isometry3d PoseFrom(const json& rows) {
  const auto numbers = rows.get<std::vector<double>>();
  if (numbers.size() != 12) throw InputError("has a pose of {} numbers", numbers.size());
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (size_t i = 0; i < numbers.size(); ++i) pose(static_cast<int>(i / 4), static_cast<int>(i % 4)) = numbers[i];
  const Eigen::Matrix3d turn = pose.linear();
  const bool turns = (turn * turn.transpose() - Eigen::Matrix3d::Identity()).norm() < kTurns && turn.determinant() > 0;
  if (!turns || !pose.translation().allFinite()) throw InputError("has a pose that is none");
  return pose;
}

/// Cameras of the given poses; the pose is all that counts.
std::vector<Camera> CamerasAsGiven(const Run& run, const std::vector<int>& views) {
  return WorkingCameras(run.Given(), views, run.plan.image);
}

}  // namespace

void WriteRefinedPoses(const std::filesystem::path& file, const std::vector<std::string>& names,
                       const std::vector<Camera>& cameras) {
  json poses = json::object();
  for (size_t v = 0; v < names.size(); ++v) poses[names[v]] = ToJson(cameras[v].cam_from_world);
  const json content = {{"cam_from_world", std::move(poses)}};
  WriteFileAtomically(file, content.dump(1) + "\n");
}

void UsePoses(Run* run, const std::vector<Camera>& training) {
  if (!run->given) run->given = run->scene;
  const std::vector<int> all = AllViews(run->scene);
  std::vector<Camera> cameras = Following(CamerasAsGiven(*run, all), CamerasAsGiven(*run, run->split.train), training);
  for (size_t t = 0; t < training.size(); ++t) cameras[static_cast<size_t>(run->split.train[t])] = training[t];
  for (const int v : all) {
    run->scene.views[static_cast<size_t>(v)].cam_from_world = cameras[static_cast<size_t>(v)].cam_from_world;
  }
  if (!run->results->views) return;
  std::vector<LoadedView>& loaded = run->results->views->views;
  for (size_t t = 0; t < loaded.size(); ++t) loaded[t].camera.cam_from_world = training[t].cam_from_world;
}

void UseRefinedPoses(Run* run) {
  const json record = run->workspace.Record("poses");
  if (!record.is_object() || record.value("result", "") != "refined") return;
  const std::filesystem::path file = run->workspace.refined_poses();
  std::vector<Camera> cameras = CamerasAsGiven(*run, run->split.train);
  try {
    const json poses = ReadRunJson(file).at("cam_from_world");
    const std::vector<std::string> names = NamesAt(run->scene, run->split.train);
    for (size_t v = 0; v < names.size(); ++v) cameras[v].cam_from_world = PoseFrom(poses.at(names[v]));
  } catch (const json::exception&) {
    throw InputError("{}: does not have the poses of this run's photos", file.string());
  } catch (const InputError& damage) {
    const std::string text = damage.what();
    throw InputError("{}", text.find(file.string()) == 0 ? text : file.string() + ": " + text);
  }
  UsePoses(run, cameras);
}

void TakeRefinedPoses(Run* run) {
  if (!IsUpToDate(run, *run->stages, "poses")) return;
  try {
    UseRefinedPoses(run);
  } catch (const InputError&) {
    RunStage(run, *run->stages, "poses");  // says so
  }
}

}  // namespace oraclegs
