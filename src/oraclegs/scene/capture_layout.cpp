#include "oraclegs/scene/capture_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <string_view>
#include <system_error>
#include <vector>

#include "oraclegs/core/text.h"
#include "oraclegs/scene/read_colmap.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<const char*>;

constexpr char kNerfstudio[] = "`ns-process-data` of Nerfstudio makes a transforms.json of them";

/// A layout is known by folders or files that are all there.
struct LayoutRow {
  const char* program;
  Names marks;
  Names photos;  ///< the first that is a folder
  Names poses;   ///< the first that exists
  const char* fix;
};

const std::vector<LayoutRow>& LayoutRows() {
  static const std::vector<LayoutRow> rows = {
      {"Polycam",
       {"keyframes"},
       {"keyframes/corrected_images", "keyframes/images"},
       {"keyframes/corrected_cameras", "keyframes/cameras"},
       kNerfstudio},
      {"Polycam", {"corrected_cameras"}, {"corrected_images"}, {"corrected_cameras"}, kNerfstudio},
      {"Polycam", {"cameras", "confidence"}, {"images"}, {"cameras"}, kNerfstudio},
      {"Record3D", {"rgbd", "metadata.json"}, {"rgbd"}, {"metadata.json"}, kNerfstudio},
      {"Record3D", {"rgbd", "metadata"}, {"rgbd"}, {"metadata"}, kNerfstudio},
      {"Record3D", {"rgb", "depth", "metadata.json"}, {"rgb"}, {"metadata.json"}, ""},
      {"ScanNet", {"color", "pose"}, {"color"}, {"pose"}, ""},
      {"ScanNet++",
       {"dslr"},
       {"dslr/resized_undistorted_images", "dslr/undistorted_images", "dslr/resized_images"},
       {"dslr/nerfstudio/transforms_undistorted.json", "dslr/nerfstudio/transforms.json", "dslr/colmap"},
       "copy them beside their images to use them"},
      {"ARKitScenes", {"lowres_wide"}, {"wide", "vga_wide", "lowres_wide"}, {"lowres_wide.traj"}, ""},
      {"TUM RGB-D", {"rgb", "rgb.txt"}, {"rgb"}, {"groundtruth.txt"}, ""},
      {"an RGB-D camera", {"color", "depth"}, {"color"}, {"pose", "poses", "poses.txt", "trajectory.log"}, ""},
      {"an RGB-D camera", {"rgb", "depth"}, {"rgb"}, {"pose", "poses", "poses.txt", "traj.txt", "odometry.csv"}, ""}};
  return rows;
}

/// Files that hold poses: NAME, *END or BEGIN*, in the folder itself.
struct PoseFileRow {
  const char* program;
  const char* name;
  const char* text;  ///< stands in the first 64 kB; empty = not looked at
  const char* fix;
};

const std::vector<PoseFileRow>& PoseFileRows() {
  constexpr char kMetashape[] = "export them there as a COLMAP model (File > Export > Export Cameras)";
  constexpr char kReality[] = "export the registration there as a COLMAP model";
  static const std::vector<PoseFileRow> rows = {
      {"Metashape", "*.xml", "<chunk", kMetashape},
      {"Metashape", "*.xml", "<cameras", kMetashape},
      {"Metashape", "*.txt", "Omega, Phi, Kappa", kMetashape},
      {"RealityScan", "*.csv", "#name,", kReality},
      {"RealityScan", "*.csv", "#cameras", kReality},
      {"RealityScan", "*.xmp", "capturingreality.com", kReality},
      {"3D Scanner App", "*.json", "cameraPoseARFrame", ""},
      {"Polycam", "*.json", "\"t_00\"", kNerfstudio},
      {"Record3D", "metadata.json", "\"poses\"", kNerfstudio},
      {"Stray Scanner", "odometry.csv", "", ""},
      {"LLFF", "poses_bounds.npy", "", ""},
      {"OpenSfM", "reconstruction.json", "\"shots\"", "`opensfm export_colmap` writes a COLMAP model"},
      {"OpenMVG", "sfm_data.json", "", "`openMVG_main_openMVG2Colmap` writes a COLMAP model"},
      {"Meshroom", "*.sfm", "\"poses\"", ""},
      {"Bundler", "bundle.out", "", ""},
      {"Bundler", "*.rd.out", "", ""},
      {"VisualSFM", "*.nvm", "NVM_V", ""},
      {"NeuS", "cameras_sphere.npz", "", ""},
      {"IDR", "cameras.npz", "", ""},
      {"3D Gaussian Splatting", "cameras.json", "\"rotation\"", ""},
      {"7-Scenes", "*.pose.txt", "", ""},
      {"a tracker", "groundtruth.txt", "", ""},
      {"a tracker", "traj.txt", "", ""},
      {"a tracker", "trajectory.txt", "", ""},
      {"a tracker", "poses.txt", "", ""},
      {"a tracker", "poses.csv", "", ""}};
  return rows;
}

constexpr size_t kMaxLookedAt = 1000, kLookBytes = 64 * 1024;

bool Exists(const fs::path& path) {
  std::error_code error;
  return fs::exists(path, error);
}

bool IsFolderThere(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

/// The first of the names that is there; null without one.
const char* FirstOf(const fs::path& dir, const Names& names) {
  const auto it = std::find_if(names.begin(), names.end(), [&](const char* name) { return Exists(dir / name); });
  return it == names.end() ? nullptr : *it;
}

bool Fits(std::string_view name, std::string_view pattern) {
  return pattern.starts_with('*') ? name.ends_with(pattern.substr(1)) : name == pattern;
}

bool BeginsWithText(const fs::path& path, std::string_view text) {
  if (text.empty()) return true;
  std::string head(kLookBytes, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<size_t>(std::max<std::streamsize>(0, file.gcount())));
  return head.find(text) != std::string::npos;
}

std::string Sentence(const std::string& poses, const std::string& program, const std::string& fix) {
  return fmt::format("{} has poses of {}, which are not read: the cameras are found anew from the photos{}{}",
                     OneLine(poses), program, fix.empty() ? "" : "; ", fix);
}

}  // namespace

std::optional<CaptureLayout> FindCaptureLayout(const fs::path& dir) {
  for (const LayoutRow& row : LayoutRows()) {
    if (!std::all_of(row.marks.begin(), row.marks.end(), [&](const char* mark) { return Exists(dir / mark); }))
      continue;
    const char* photos = FirstOf(dir, row.photos);
    if (photos == nullptr || !IsFolderThere(dir / photos)) continue;
    const char* poses = FirstOf(dir, row.poses);
    return CaptureLayout{row.program, dir / photos, poses == nullptr ? "" : poses, row.fix};
  }
  return std::nullopt;
}

std::string DescribeUnreadPoses(const CaptureLayout& layout) {
  return layout.poses.empty() ? "" : Sentence(layout.poses, layout.program, layout.fix);
}

std::string DescribeUnreadPoses(const fs::path& dir) {
  std::vector<fs::path> entries;
  std::error_code error;
  for (fs::directory_iterator it(dir, error), end; !error && it != end; it.increment(error)) {
    if (!it->path().filename().string().starts_with(".")) entries.push_back(it->path());
  }
  std::sort(entries.begin(), entries.end());
  size_t looked_at = 0;
  for (const PoseFileRow& row : PoseFileRows()) {
    for (const fs::path& path : entries) {
      if (!Fits(path.filename().string(), row.name) || !fs::is_regular_file(path, error)) continue;
      if (++looked_at > kMaxLookedAt) return "";
      if (BeginsWithText(path, row.text)) return Sentence(path.filename().string(), row.program, row.fix);
    }
  }
  for (const fs::path& path : entries) {
    if (!IsFolderThere(path) || Exists(path / "options.json")) continue;  // the latter is of a run of ours
    const std::string name = path.filename().string();
    for (const char* file : {"transforms.json", "transforms_train.json"}) {
      if (Exists(path / file)) return Sentence(name + "/" + file, "a scene", "name its folder to use them");
    }
    for (const fs::path& model : {path, path / "0", path / "sparse", path / "sparse/0"}) {
      if (IsColmapModel(model)) {
        return Sentence(model.lexically_relative(dir).string(), "COLMAP", "move that folder to sparse/0 to use them");
      }
    }
  }
  return "";
}

}  // namespace oraclegs
