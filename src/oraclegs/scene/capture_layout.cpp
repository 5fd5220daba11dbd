#include "oraclegs/scene/capture_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string_view>
#include <system_error>
#include <vector>

#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"
#include "oraclegs/scene/read_colmap.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<const char*>;

constexpr char kNerfstudio[] = "`ns-process-data` of Nerfstudio makes a transforms.json of them";

constexpr char kMetashape[] = "export them there as a COLMAP model (File > Export > Export Cameras)";
constexpr char kReality[] = "export `Internal/External camera parameters` there and name that folder alone";
constexpr char kBundler[] = "name its folder alone, with its list.txt, to use them";
constexpr char kAlone[] = "name its folder alone to use them";

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
       kAlone},
      {"Polycam", {"corrected_cameras"}, {"corrected_images"}, {"corrected_cameras"}, kAlone},
      {"Polycam", {"cameras", "confidence"}, {"images"}, {"cameras"}, kAlone},
      {"Record3D", {"rgbd", "metadata.json"}, {"rgbd"}, {"metadata.json"}, kAlone},
      {"Record3D", {"rgbd", "metadata"}, {"rgbd"}, {"metadata"}, kAlone},
      {"Record3D", {"rgb", "depth", "metadata.json"}, {"rgb"}, {"metadata.json"}, kAlone},
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

/// Files that hold poses.
struct PoseFileRow {
  const char* program;  ///< may be empty
  const char* name;     ///< a path below the folder, or "*END" of a file in it
  const char* text;     ///< stands in the first 64 kB; empty = not looked at
  const char* fix;
};

const std::vector<PoseFileRow>& PoseFileRows() {
  static const std::vector<PoseFileRow> rows = {
      {"Metashape", "*.xml", "<chunk", kAlone},
      {"Metashape", "*.txt", "Omega, Phi, Kappa", kMetashape},
      {"RealityScan", "*.csv", "#name,", kReality},
      {"RealityScan", "*.csv", "#cameras", kReality},
      {"RealityScan", "*.xmp", "capturingreality.com", kReality},
      {"3D Scanner App", "*.json", "cameraPoseARFrame", ""},
      {"Polycam", "*.json", "\"t_00\"", kNerfstudio},
      {"Record3D", "metadata.json", "\"poses\"", kAlone},
      {"Stray Scanner", "odometry.csv", "", ""},
      {"LLFF", "poses_bounds.npy", "", kAlone},
      {"OpenSfM", "reconstruction.json", "\"shots\"", "`opensfm export_colmap` writes a COLMAP model"},
      {"OpenDroneMap", "opensfm/reconstruction.json", "\"shots\"", "`opensfm export_colmap` writes a COLMAP model"},
      {"OpenMVG", "sfm_data.json", "", "`openMVG_main_openMVG2Colmap` writes a COLMAP model"},
      {"Meshroom", "*.sfm", "\"poses\"", ""},
      {"Bundler", "bundle.out", "", kBundler},
      {"Bundler", "*.rd.out", "", kBundler},
      {"VisualSFM", "*.nvm", "NVM_V", ""},
      {"NeuS", "cameras_sphere.npz", "", kAlone},
      {"IDR", "cameras.npz", "", kAlone},
      {"3D Gaussian Splatting", "cameras.json", "\"rotation\"", ""},
      {"7-Scenes", "*.pose.txt", "", ""},
      {"", "groundtruth.txt", "", ""},
      {"", "traj.txt", "", ""},
      {"", "trajectory.txt", "", ""},
      {"", "poses.txt", "", ""},
      {"", "poses.csv", "", ""}};
  return rows;
}

constexpr size_t kMaxLookedAt = 1000, kLookBytes = 64 * 1024;

bool Exists(const fs::path& path) {
  std::error_code error;
  return fs::exists(path, error);
}

std::string BelowLayout(const fs::path& dir, const fs::path& path) {
  return path.lexically_relative(dir).generic_string();
}

/// The first of the names that is there; null without one.
const char* FirstOf(const fs::path& dir, const Names& names) {
  const auto it = std::find_if(names.begin(), names.end(), [&](const char* name) { return Exists(dir / name); });
  return it == names.end() ? nullptr : *it;
}

bool BeginsWithText(const fs::path& path, std::string_view text) {
  if (text.empty()) return true;
  return ReadHead(path, kLookBytes).find(text) != std::string::npos;
}

std::string Sentence(const std::string& poses, const std::string& program, const std::string& fix) {
  return fmt::format("{} has poses{}{}, which are not read: the cameras are found anew from the photos{}{}",
                     OneLine(poses), program.empty() ? "" : " of ", program, fix.empty() ? "" : "; ", fix);
}

/// The files that a row means, below `dir`, whose entries are given.
std::vector<fs::path> FilesOf(const PoseFileRow& row, const fs::path& dir, const std::vector<fs::path>& entries) {
  const std::string_view name = row.name;
  std::vector<fs::path> files;
  if (!name.starts_with('*')) {
    if (IsFile(dir / name)) files.push_back(dir / name);
    return files;
  }
  std::copy_if(entries.begin(), entries.end(), std::back_inserter(files), [&](const fs::path& path) {
    return path.filename().string().ends_with(name.substr(1)) && IsFile(path);
  });
  return files;
}

/// Paths of what is not hidden in a folder, sorted.
std::vector<fs::path> EntriesOf(const fs::path& dir) {
  std::vector<fs::path> entries;
  std::error_code error;
  for (fs::directory_iterator it(dir, error), end; !error && it != end; it.increment(error)) {
    if (!it->path().filename().string().starts_with(".")) entries.push_back(it->path());
  }
  std::sort(entries.begin(), entries.end());
  return entries;
}

}  // namespace

std::optional<CaptureLayout> FindCaptureLayout(const fs::path& dir) {
  for (const LayoutRow& row : LayoutRows()) {
    if (!std::all_of(row.marks.begin(), row.marks.end(), [&](const char* mark) { return Exists(dir / mark); }))
      continue;
    const char* photos = FirstOf(dir, row.photos);
    if (photos == nullptr || !IsFolder(dir / photos)) continue;
    const char* poses = FirstOf(dir, row.poses);
    return CaptureLayout{row.program, dir / photos, poses == nullptr ? "" : poses, row.fix};
  }
  return std::nullopt;
}

std::string DescribeUnreadPoses(const CaptureLayout& layout) {
  return layout.poses.empty() ? "" : Sentence(layout.poses, layout.program, layout.fix);
}

std::string DescribeUnreadPoses(const fs::path& dir) {
  const std::vector<fs::path> entries = EntriesOf(dir);
  size_t looked_at = 0;
  for (const PoseFileRow& row : PoseFileRows()) {
    for (const fs::path& path : FilesOf(row, dir, entries)) {
      if (++looked_at > kMaxLookedAt) return "";
      if (BeginsWithText(path, row.text)) return Sentence(BelowLayout(dir, path), row.program, row.fix);
    }
  }
  return "";
}

std::string DescribeScenePoses(const fs::path& dir) {
  std::vector<fs::path> folders = EntriesOf(dir);
  folders.insert(folders.begin(), dir);
  for (const fs::path& path : folders) {
    if (!IsFolder(path) || Exists(path / "options.json")) continue;  // the latter is of a run of ours
    for (const char* file : {"transforms.json", "transforms_train.json"}) {
      if (Exists(path / file)) return Sentence(BelowLayout(dir, path / file), "", kAlone);
    }
    for (const fs::path& model : {path, path / "0", path / "sparse", path / "sparse/0"}) {
      if (!IsColmapModel(model)) continue;
      return Sentence(model == dir ? "it" : BelowLayout(dir, model), "COLMAP", kAlone);
    }
  }
  return "";
}

}  // namespace oraclegs
