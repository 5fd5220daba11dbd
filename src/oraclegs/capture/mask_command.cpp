#include "oraclegs/capture/mask_command.h"

#include <algorithm>
#include <system_error>
#include <vector>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/user_command.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/scene/loaded_view.h"
#include "oraclegs/scene/masks.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> MaskFiles(const fs::path& dir, const Scene& scene) {
  std::vector<fs::path> files;
  for (const std::string& name : FileNames(NamesAt(scene, AllViews(scene)))) files.push_back(dir / (name + ".png"));
  return files;
}

Image8 PhotoAsRead(const SceneView& view) {
  const auto orientation = FittingOrientation(view, view.image_path, view.intrinsics.width, view.intrinsics.height);
  return ReadImage(view.image_path, orientation.value_or(Orientation::kUpright));
}

void WriteRequest(const fs::path& dir, const Scene& scene) {
  const std::vector<fs::path> files = MaskFiles(dir, scene);
  ParallelFor(static_cast<int64_t>(files.size()), [&](int64_t i) {
    ThrowIfInterrupted();
    const auto v = static_cast<size_t>(i);
    WritePng(files[v], PhotoAsRead(scene.views[v]));
  });
}

size_t CountFiles(const std::vector<fs::path>& files) {
  return static_cast<size_t>(std::count_if(files.begin(), files.end(), IsFile));
}

/// Stores the answer, less the pixels that a face does not have: those outside of its own mask (scene/spheres.h).
void StoreBoth(const SceneView& answered, const SceneView& view, const fs::path& to) {
  const Image8 own = ReadMask(view, view.intrinsics.width, view.intrinsics.height, Orientation::kUpright);
  Image8 both = ReadMask(answered, own.width, own.height, Orientation::kUpright);
  for (int64_t y = 0, i = 0; y < both.height; ++y) {
    for (int64_t x = 0; x < both.width; ++x, ++i) {
      const int64_t at = y * own.height / both.height * own.width + x * own.width / both.width;
      uint8_t& level = both.data[static_cast<size_t>(i)];
      level = std::min(level, own.data[static_cast<size_t>(at)]) > 0 ? answered.mask_white : uint8_t{0};
    }
  }
  WritePng(to, both);
}

}  // namespace

void MakeMasks(const MaskRun& run, const Scene& scene, const Listener& listener) {
  const CommandFolders folders{fs::absolute(run.root / "command")};
  EmptyCommandFolders(folders);
  WriteRequest(folders.request(), scene);
  const std::vector<fs::path> answers = MaskFiles(folders.answer(), scene);
  RunUserCommand({"--masks", run.command, run.timeout, folders},
                 {"masks", "masks", answers.size(), [&] { return CountFiles(answers); }}, listener);
  const auto missing = std::find_if_not(answers.begin(), answers.end(), IsFile);
  if (missing != answers.end()) {
    throw InputError(
        "{}: is missing: the command of --masks has to write one mask for each photo of {}, and wrote {} of {}; what "
        "it printed is in {}",
        missing->string(), folders.request().string(), CountFiles(answers), answers.size(), folders.log().string());
  }
  Scene answered = scene;
  TakeMasks(folders.answer(), Silent(), &answered);
  const std::vector<fs::path> stored = MaskFiles(run.root, scene);
  for (size_t v = 0; v < answers.size(); ++v) {
    std::error_code error;
    if (scene.views[v].sphere && !scene.views[v].mask_path.empty()) {
      StoreBoth(answered.views[v], scene.views[v], stored[v]);
      continue;
    }
    fs::rename(answers[v], stored[v], error);
    if (error) throw RunError("{}: cannot be written: {}", stored[v].string(), SystemReason(error));
  }
  std::error_code ignored;  // copies of photos, which take much room
  for (const fs::path& folder : {folders.request(), folders.answer()}) fs::remove_all(folder, ignored);
}

void TakeMasks(const fs::path& root, const Listener& listener, Scene* scene) {
  const std::vector<fs::path> files = MaskFiles(root, *scene);
  for (size_t v = 0; v < files.size(); ++v) {
    if (!IsFile(files[v])) throw InputError("{}: no such file; run the command again", files[v].string());
    scene->views[v].mask_path = files[v];
  }
  CheckMasks(scene, listener);
}

}  // namespace oraclegs
