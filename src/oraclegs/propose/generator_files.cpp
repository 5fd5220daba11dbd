#include "oraclegs/propose/generator_files.h"

#include <algorithm>
#include <optional>

#include "oraclegs/core/error.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/text.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/propose/proposal_files.h"
#include "oraclegs/scene/transforms_frame.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr float kShown = 0.5f;  // views that have to show a pixel's point

void WriteViews(const fs::path& dir, const std::vector<LoadedView>& views, const Similarity& placement) {
  std::vector<std::string> names;
  std::vector<Target> cameras;
  for (const LoadedView& view : views) {
    names.push_back(view.name);
    cameras.push_back({view.name, view.camera});
  }
  const std::vector<std::string> files = FileNames(names);
  for (size_t v = 0; v < views.size(); ++v) WritePng(dir / (files[v] + ".png"), ToImage8(views[v].rgb));
  WriteTargets(dir, cameras, placement);
}

Image8 ReadAnswer(const fs::path& file, const Camera& camera) {
  std::optional<Image8> image;
  try {
    image = ReadImage(file);
  } catch (const InputError& error) {
    throw InputError("{}; the generator has to write it as 8-bit PNG or JPEG", error.what());
  }
  if (image->width != camera.width || image->height != camera.height) {
    throw InputError(
        "{}: is {} x {}, its pose is for {} x {}; the generator has to write the size that w and h of its "
        "frame in transforms.json say",
        file.string(), image->width, image->height, camera.width, camera.height);
  }
  if (image->channels != 3) {
    throw InputError("{}: has transparent pixels; the generator has to write it without an alpha channel",
                     file.string());
  }
  return std::move(*image);
}

}  // namespace

std::vector<uint8_t> KnownPixels(const WarpedView& view) {
  std::vector<uint8_t> known;
  known.reserve(view.evidence.size());
  for (const PixelEvidence& e : view.evidence) {
    known.push_back(e.background > 0 || (e.ring == 0 && e.views >= kShown) ? 255 : 0);
  }
  return known;
}

void WriteGeneratorRequest(const CommandFolders& paths, const std::vector<Target>& targets,
                           const std::vector<LoadedView>& views, const Warper& warper, const Similarity& placement) {
  EmptyCommandFolders(paths);
  WriteViews(paths.request() / "images", views, placement);
  WriteTargets(paths.request(), targets, placement);
  ParallelFor(static_cast<int64_t>(targets.size()), [&](int64_t task) {
    ThrowIfInterrupted();
    const auto& [name, camera] = targets[static_cast<size_t>(task)];
    const WarpedView view = warper.Warp(camera);
    WritePng(paths.request() / "warps" / (name + ".png"), ToImage8(view.rgb));
    WritePng(paths.request() / "masks" / (name + ".png"), {camera.width, camera.height, 1, KnownPixels(view)});
  });
}

size_t CountAnswers(const CommandFolders& paths, const std::vector<Target>& targets) {
  return static_cast<size_t>(std::count_if(targets.begin(), targets.end(), [&](const Target& target) {
    return !FindFrameImage(paths.answer(), target.name).empty();
  }));
}

std::vector<Image8> ReadAnswers(const CommandFolders& paths, const std::vector<Target>& targets) {
  std::vector<fs::path> files;
  std::vector<std::string> missing;
  for (const Target& target : targets) {
    files.push_back(FindFrameImage(paths.answer(), target.name));
    if (files.back().empty()) missing.push_back(target.name + ".png");
  }
  if (!missing.empty()) {
    throw InputError(
        "{}: is missing ({} of {} images are: {}); the generator has to write one for every frame of {}; "
        "what it printed is in {}",
        (paths.answer() / missing[0]).string(), missing.size(), targets.size(), SomeNames(missing),
        (paths.request() / "transforms.json").string(), paths.log().string());
  }
  std::vector<Image8> images;
  for (size_t t = 0; t < targets.size(); ++t) images.push_back(ReadAnswer(files[t], targets[t].camera));
  return images;
}

}  // namespace oraclegs
