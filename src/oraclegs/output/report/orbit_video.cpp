#include "oraclegs/output/report/orbit_video.h"

#include <algorithm>
#include <cmath>

#include "oraclegs/camera/camera_path.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/output/report/ffmpeg.h"
#include "oraclegs/render/render.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr int kEven = 2;  // H.264 with halved color needs sides that are multiples of this

/// Camera scaled to at most `max_side`, with even sides.
Camera FilmCamera(const Camera& camera, int max_side) {
  const double scale = std::min(1.0, static_cast<double>(max_side) / std::max(camera.width, camera.height));
  const auto side = [&](int pixels) {
    return std::max(kEven, static_cast<int>(std::lround(pixels * scale / kEven)) * kEven);
  };
  return Resized(camera, side(camera.width), side(camera.height));
}

std::vector<std::string> EncoderArguments(const fs::path& ffmpeg, const Camera& camera, double fps,
                                          const fs::path& out) {
  return {ffmpeg.string(),
          "-y",
          "-loglevel",
          "error",
          "-f",
          "rawvideo",
          "-pix_fmt",
          "rgb24",
          "-s",
          fmt::format("{}x{}", camera.width, camera.height),
          "-framerate",
          fmt::format("{:.6f}", fps),
          "-i",
          "pipe:0",
          "-c:v",
          "libx264",
          "-preset",
          "veryfast",
          "-crf",
          "20",
          "-pix_fmt",
          "yuv420p",
          "-movflags",
          "+faststart",
          "-f",
          "mp4",
          out.string()};
}

std::string PixelBytes(const RenderOutput& render) {
  const Image8 image = ToImage8(render.image);
  return {image.data.begin(), image.data.end()};
}

}  // namespace

bool WriteOrbitVideo(const Model& model, const std::vector<Camera>& training_cameras, const fs::path& video,
                     const OrbitVideo& how, const Listener& listener) {
  const fs::path part =
      fs::absolute(video).replace_extension(".mp4.tmp");  // absolute: ffmpeg reads "a:" at the beginning as a protocol
  std::error_code error;
  fs::remove(part, error);  // left by a run that was killed
  if (training_cameras.empty() || how.frames <= 0) return false;
  const fs::path ffmpeg = FindProgram("ffmpeg");
  if (ffmpeg.empty()) {
    listener(Note{"ffmpeg is not installed: no video of an orbit"});
    return false;
  }
  std::vector<Camera> path = OrbitPath(training_cameras, how.frames);
  for (Camera& camera : path) camera = FilmCamera(camera, how.max_side);
  const auto rasterizer = MakeRasterizer(model.gaussians.device());
  size_t rendered = 0;
  ProcessRequest request;
  request.argv = EncoderArguments(ffmpeg, path.front(), how.frames / how.seconds, part);
  request.next_input = [&]() -> std::string {
    ThrowIfInterrupted();
    if (rendered == path.size()) return "";
    const Camera& camera = path[rendered++];
    return PixelBytes(rasterizer->Forward(model.gaussians, camera, model.render, RenderPass::kInference));
  };
  std::string why;
  try {
    RequireWritableFolder(video.parent_path());
    why = RunFfmpeg(request);
    if (why.empty()) fs::rename(part, video, error);
    if (error) why = SystemReason(error);
  } catch (const RunError& failed) {
    why = failed.what();
  } catch (...) {
    fs::remove(part, error);
    throw;
  }
  if (!why.empty()) {
    fs::remove(part, error);
    listener(Warning{fmt::format("{}: {}: no video", video.string(), why)});
    return false;
  }
  listener(FileWritten{video});
  return true;
}

fs::path WriteOrbitVideo(const Run& run, const Model& model, const OrbitVideo& how) {
  const std::vector<Camera> cameras = WorkingCameras(run.scene, run.split.train, run.plan.image);
  const fs::path video = run.workspace.renders("orbit") / "video.mp4";
  return WriteOrbitVideo(model, cameras, video, how, run.listener) ? video : fs::path();
}

}  // namespace oraclegs
