#include "oraclegs/propose/proposal_files.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/scene/scene.h"
#include "oraclegs/scene/transforms_frame.h"

namespace oraclegs {
namespace {
namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kTransforms = "transforms.json";

json FrameOf(const std::string& name, const Camera& camera) {
  Eigen::Matrix4d world_from_cam = camera.cam_from_world.inverse().matrix();
  world_from_cam.col(1) *= -1;  // y down and z forward become OpenGL's y up and z backward
  world_from_cam.col(2) *= -1;
  json matrix = json::array();
  for (int r = 0; r < 4; ++r) {
    json row = json::array();
    for (int c = 0; c < 4; ++c) row.push_back(world_from_cam(r, c));
    matrix.push_back(std::move(row));
  }
  return {{"file_path", name + ".png"}, {"w", camera.width}, {"h", camera.height}, {"fl_x", camera.fx},
          {"fl_y", camera.fy},          {"cx", camera.cx},   {"cy", camera.cy},    {"transform_matrix", matrix}};
}

void WriteFrames(const fs::path& dir, const std::vector<std::string>& names, const std::vector<Camera>& cameras) {
  json frames = json::array();
  for (size_t i = 0; i < names.size(); ++i) frames.push_back(FrameOf(names[i], cameras[i]));
  WriteFileAtomically(dir / kTransforms, json{{"camera_model", "PINHOLE"}, {"frames", frames}}.dump(1) + "\n");
}

}  // namespace

std::vector<std::string> WriteProposals(const fs::path& dir, const std::vector<Proposal>& proposals,
                                        const Similarity& placement) {
  std::map<std::string, int> candidates;
  for (const Proposal& proposal : proposals) ++candidates[FileName(proposal.name)];
  std::vector<std::string> wanted, files;
  std::vector<Camera> cameras;
  for (const Proposal& p : proposals) {
    if (p.rgb.width != p.camera.width || p.rgb.height != p.camera.height || p.rgb.channels != 3) {
      throw ShapeError("WriteProposals: {} is {} x {} x {}, its camera {} x {}", p.name, p.rgb.width, p.rgb.height,
                       p.rgb.channels, p.camera.width, p.camera.height);
    }
    const std::string name = FileName(p.name);
    wanted.push_back(candidates[name] > 1 ? name + "_" + p.source : name);
    cameras.push_back(p.camera);
    cameras.back().cam_from_world = Moved(p.camera.cam_from_world, placement);
  }
  const std::vector<std::string> names = FileNames(wanted);
  for (size_t i = 0; i < proposals.size(); ++i) {
    files.push_back(names[i] + ".png");
    WritePng(dir / files.back(), ToImage8(proposals[i].rgb));
  }
  WriteFrames(dir, names, cameras);
  files.emplace_back(kTransforms);
  return files;
}

std::vector<std::string> WriteTargets(const fs::path& dir, const std::vector<Target>& targets,
                                      const Similarity& placement) {
  std::vector<std::string> names;
  std::vector<Camera> cameras;
  for (const Target& target : targets) {
    names.push_back(target.name);
    cameras.push_back(target.camera);
    cameras.back().cam_from_world = Moved(target.camera.cam_from_world, placement);
  }
  WriteFrames(dir, FileNames(names), cameras);
  return {kTransforms};
}

std::vector<Target> ReadTargets(const fs::path& dir) {
  const fs::path path = dir / kTransforms;
  const json file = ReadTransformsFile(path);
  std::set<std::string> names;
  std::vector<Target> targets;
  int index = 0;
  for (const json& entry : file["frames"]) {
    const auto [frame, file_path] = NamedFrame(file, entry, path, index++);
    Target target{FileName(file_path), {}};
    const Intrinsics intrinsics = ReadTransformsIntrinsics(frame, dir / file_path);
    if (intrinsics.model != CameraModel::kPinhole) {
      throw InputError("{}: its camera model is {}, a target needs a pinhole; remove the distortion", frame.place,
                       CameraModelName(intrinsics.model));
    }
    if (!names.insert(target.name).second) {
      throw InputError("{}: another frame is called '{}', too; rename one", frame.place, target.name);
    }
    target.camera = {intrinsics.width,
                     intrinsics.height,
                     intrinsics.fx(),
                     intrinsics.fy(),
                     intrinsics.cx(),
                     intrinsics.cy(),
                     ReadTransformsPose(frame).cam_from_world};
    targets.push_back(std::move(target));
  }
  return targets;
}

std::optional<Proposal> StoredProposer::Propose(const Target& target, std::optional<int> held_out) const {
  if (held_out) return std::nullopt;
  const std::filesystem::path path = folder_ / (target.name + ".png");
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return std::nullopt;
  Proposal proposal{target.name, source_, target.camera, ToFloat(ReadImage(path))};
  const ImageF& rgb = proposal.rgb;
  if (rgb.width != target.camera.width || rgb.height != target.camera.height || rgb.channels != 3) {
    throw InputError("{}: is {} x {} with {} channels, not {} x {} with 3; delete it and run again", path.string(),
                     rgb.width, rgb.height, rgb.channels, target.camera.width, target.camera.height);
  }
  return proposal;
}

}  // namespace oraclegs
