#include "oraclegs/output/render_path.h"

#include "oraclegs/camera/camera_path.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/evaluate/image_names.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/output/report/ffmpeg.h"
#include "oraclegs/output/report/value_images.h"
#include "oraclegs/settings/device.h"
#include "oraclegs/stages/stage_clock.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

/// List for ffmpeg's concat demuxer, which takes images of any name.
std::string FfmpegList(const std::vector<fs::path>& images, int fps) {
  std::string list = "ffconcat version 1.0\n";
  for (const fs::path& image : images) {
    std::string quoted;
    for (const char c : fs::absolute(image).string()) quoted += c == '\'' ? "'\\''" : std::string(1, c);
    list += fmt::format("file '{}'\nduration {:.9f}\n", quoted, 1.0 / fps);
  }
  return list;
}

bool WriteVideo(const std::vector<fs::path>& images, const fs::path& video, int fps, const Listener& listener) {
  const fs::path ffmpeg = FindProgram("ffmpeg");
  if (ffmpeg.empty()) {
    listener(Note{"ffmpeg is not installed: no video, the images are there"});
    return false;
  }
  const fs::path whole = fs::absolute(video);  // ffmpeg reads "a:" at the beginning as a protocol
  const fs::path list = fs::path(whole).replace_extension(".txt.tmp"),
                 part = fs::path(whole).replace_extension(".mp4.tmp");
  WriteFileAtomically(list, FfmpegList(images, fps));
  std::string why = RunFfmpeg({.argv = {ffmpeg.string(), "-y", "-loglevel", "error", "-f", "concat", "-safe", "0", "-i",
                                        list.string(), "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-r",
                                        std::to_string(fps), "-pix_fmt", "yuv420p", "-f", "mp4", part.string()}});
  std::error_code error;
  fs::remove(list, error);
  if (why.empty()) fs::rename(part, whole, error);
  if (error) why = SystemReason(error);
  if (!why.empty()) {
    fs::remove(part, error);
    listener(Warning{fmt::format("{}: {}: no video, the images are there", video.string(), why)});
    return false;
  }
  listener(FileWritten{video});
  return true;
}

std::vector<Camera> FlightPath(const std::vector<Camera>& cameras, const RenderPathOptions& options) {
  switch (options.path) {
    case PathKind::kSpiral:
      return SpiralPath(cameras, options.frames);
    case PathKind::kInterpolate:
      return InterpolatedPath(cameras, options.frames);
    default:
      return OrbitPath(cameras, options.frames);
  }
}

}  // namespace

std::vector<NamedCamera> PathCameras(const PosedScene& posed, const ImageOptions& image,
                                     const RenderPathOptions& options) {
  const std::vector<int>& views = options.path == PathKind::kTest ? posed.split.test : posed.split.train;
  const std::vector<Camera> cameras = WorkingCameras(posed.scene, views, image);
  std::vector<std::string> names;
  for (const int i : views) names.push_back(posed.scene.views[static_cast<size_t>(i)].name);
  std::vector<NamedCamera> named;
  if (options.path == PathKind::kTrain || options.path == PathKind::kTest) {
    names = ImageNames(names);
    for (size_t i = 0; i < names.size(); ++i) named.push_back({names[i], cameras[i]});
    return named;
  }
  for (const Camera& camera : FlightPath(cameras, options)) {
    named.push_back({fmt::format("{:04d}", named.size()), camera});
  }
  return named;
}

std::vector<fs::path> RenderCameras(const Model& model, const std::vector<NamedCamera>& cameras, const fs::path& out,
                                    const RenderPathOptions& options, const Listener& listener) {
  CheckOptions(options);
  const std::vector<RenderValue> values = ParseRenderValues(options.what);
  std::vector<Camera> poses;
  for (const NamedCamera& named : cameras) poses.push_back(named.camera);
  RequireWritableFolder(out);
  const StageClock clock("render", listener);
  ReportDevice(model.gaussians.device(), ProbeDevices(), listener);
  ValueRenderer renderer(model, values, poses);
  std::vector<fs::path> folders;
  for (const RenderValue value : values) folders.push_back(value == RenderValue::kColor ? out : out / Word(value));
  for (const fs::path& folder : folders) RequireWritableFolder(folder);
  std::vector<std::vector<fs::path>> files(values.size());
  for (size_t i = 0; i < cameras.size(); ++i) {
    ThrowIfInterrupted();
    const std::vector<Image8> images = renderer.Render(cameras[i].camera);
    for (size_t v = 0; v < values.size(); ++v) {
      files[v].push_back(fs::absolute(folders[v] / (cameras[i].name + ".png")));
      WritePng(files[v].back(), images[v]);
    }
    listener(StepDone{"render", static_cast<int64_t>(i + 1), static_cast<int64_t>(cameras.size()), "images", ""});
  }
  std::vector<fs::path> videos;
  for (size_t v = 0; v < values.size() && options.video && cameras.size() > 1; ++v) {
    const fs::path video =
        folders[v] / "video.mp4";  // inside the folder that the user named; files beside it are not ours
    if (WriteVideo(files[v], video, options.fps, listener)) videos.push_back(video);
  }
  clock.Finish();
  listener(FileWritten{out});
  return videos;
}

}  // namespace oraclegs
