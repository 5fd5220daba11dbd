#include "oraclegs/capture/video.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

#include "oraclegs/capture/sharpness.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/find_program.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/subprocess.h"
#include "oraclegs/core/system_reason.h"
#include "oraclegs/core/text.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/image/heif.h"
#include "oraclegs/image/thumbnail.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr int kCandidates = 5;  // frames looked at for each that is taken
constexpr int kMinFrames = 3;
constexpr int kSharpnessSide = 960;
constexpr std::chrono::duration<double> kProbeLimit{60};

/// As an argument that is neither an option nor an address to ffmpeg.
std::string FileArgument(const fs::path& path) { return "file:" + fs::absolute(path).string(); }

void RequireFfmpeg(const fs::path& video) {
  if (!FindProgram("ffmpeg").empty() && !FindProgram("ffprobe").empty()) return;
  throw InputError(
      "{}: the ffmpeg program, which takes photos out of videos, is not installed; install it (Debian: apt install "
      "ffmpeg) or give photos",
      video.string());
}

[[noreturn]] void RefuseVideo(const fs::path& video, const std::string& why) {
  throw InputError("{}: holds no video that ffmpeg can read{}; copy it again or convert it to MP4 (H.264)",
                   video.string(), why.empty() ? "" : fmt::format(" ({})", Printable(why)));
}

/// Throws RunError when the program did not end by itself, which is not the video's fault.
void RequireUndisturbed(const fs::path& video, const ProcessResult& result) {
  if (result.stalled) {
    throw RunError(
        "{}: ffmpeg did nothing for {:g} s and was ended (more patience: ORACLEGS_STALL_LIMIT=SECONDS); run the same "
        "command again",
        video.string(), StallLimit().count());
  }
  if (WasKilled(result.exit_code)) {
    throw RunError("{}: ffmpeg was killed from outside, as happens when memory runs out; run the same command again",
                   video.string());
  }
  if (result.exit_code == kCannotStart) {
    throw RunError("{}: ffmpeg cannot be run{}; see that ffmpeg works, and run the same command again", video.string(),
                   result.last_error.empty() ? "" : fmt::format(" ({})", Printable(result.last_error)));
  }
}

double NumberOf(const nlohmann::json& json, const char* key) {
  const nlohmann::json value = json.is_object() ? json.value(key, nlohmann::json()) : nlohmann::json();
  return value.is_string() ? std::strtod(value.get<std::string>().c_str(), nullptr) : 0;
}

/// "30000/1001"
double RateOf(const nlohmann::json& stream) {
  int up = 0, down = 0;
  const nlohmann::json rate = stream.value("avg_frame_rate", nlohmann::json());
  if (!rate.is_string() || std::sscanf(rate.get<std::string>().c_str(), "%d/%d", &up, &down) != 2) return 0;
  return up > 0 && down > 0 ? static_cast<double>(up) / down : 0;
}

/// The candidates, as ffmpeg numbers them.
std::vector<fs::path> Candidates(const fs::path& dir) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(dir)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// "DIR/%06d.jpg" as ffmpeg reads it: any % of the folder's own is doubled.
std::string NumberedFiles(const fs::path& dir) {
  std::string text;
  for (const char c : dir.string()) text += c == '%' ? "%%" : std::string(1, c);
  return text + "/%06d.jpg";
}

}  // namespace

bool LooksLikeVideo(const fs::path& path) {
  static constexpr std::array<std::string_view, 14> kKnown = {".mp4",  ".mov",  ".m4v",  ".avi", ".mkv",
                                                              ".webm", ".mts",  ".m2ts", ".3gp", ".wmv",
                                                              ".mpg",  ".mpeg", ".ogv",  ".flv"};
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (std::find(kKnown.begin(), kKnown.end(), extension) != kKnown.end()) return true;
  std::ifstream file(path, std::ios::binary);
  std::string head(16, '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  const std::string_view bytes = head;
  return (bytes.substr(4, 4) == "ftyp" && !IsHeif(bytes)) || bytes.starts_with("\x1A\x45\xDF\xA3") ||
         (bytes.starts_with("RIFF") && bytes.substr(8, 4) == "AVI ");
}

VideoInfo ParseProbe(std::string_view output, const fs::path& video) {
  const size_t begin = output.find('{'), end = output.rfind('}');
  if (begin == std::string::npos || end == std::string::npos || end < begin) RefuseVideo(video, "");
  const nlohmann::json probed = ParseJsonOrDiscard(output.substr(begin, end - begin + 1));
  if (!probed.is_object() || !probed.contains("streams") || !probed["streams"].is_array() ||
      probed["streams"].empty() || !probed["streams"][0].is_object()) {
    RefuseVideo(video, "no picture track");
  }
  const nlohmann::json& stream = probed["streams"][0];
  VideoInfo info;
  info.seconds = NumberOf(stream, "duration");
  if (!(info.seconds > 0)) info.seconds = NumberOf(probed.value("format", nlohmann::json::object()), "duration");
  const double packets = NumberOf(stream, "nb_read_packets"), rate = RateOf(stream);
  if (!(info.seconds > 0) && rate > 0) info.seconds = packets / rate;
  info.frames_per_second = packets / info.seconds;
  if (!(packets >= kMinFrames) || !(info.seconds > 0) || !std::isfinite(info.frames())) {
    throw InputError("{}: is too short, with {:.0f} frames; film ten seconds or more while you walk around",
                     video.string(), packets);
  }
  return info;
}

VideoInfo ProbeVideo(const fs::path& video) {
  RequireFfmpeg(video);
  std::error_code error;
  if (fs::is_regular_file(video, error) && fs::file_size(video, error) == 0) {
    throw InputError("{}: is empty; copy the video again", video.string());
  }
  std::string json;
  ProcessRequest request;
  request.argv = {"ffprobe",
                  "-v",
                  "error",
                  "-select_streams",
                  "v:0",
                  "-count_packets",
                  "-show_entries",
                  "stream=avg_frame_rate,nb_read_packets,duration:format=duration",
                  "-of",
                  "json",
                  FileArgument(video)};
  request.errors_apart = true;
  request.time_limit = kProbeLimit;
  const ProcessResult result = RunProcess(request);
  if (result.timed_out) {
    throw InputError("{}: takes too long to read; copy it to a disk of this machine, or cut a shorter piece",
                     video.string());
  }
  RequireUndisturbed(video, result);
  if (result.exit_code != 0) RefuseVideo(video, result.last_error);
  return ParseProbe(result.output, video);
}

void ExtractFrames(const fs::path& video, int frames, const fs::path& dir, const Listener& listener) {
  const VideoInfo info = ProbeVideo(video);
  const fs::path all = dir / "candidates";
  std::error_code error;
  fs::create_directories(all, error);
  if (error) throw RunError("{}: cannot be made: {}", all.string(), SystemReason(error));

  const double wanted = std::min(static_cast<double>(frames) * kCandidates, std::floor(info.frames()));
  const auto total = static_cast<int64_t>(wanted);
  ProcessRequest request;
  request.argv = {"ffmpeg",
                  "-nostdin",
                  "-hide_banner",
                  "-loglevel",
                  "error",
                  "-progress",
                  "pipe:1",
                  "-i",
                  FileArgument(video),
                  "-map",
                  "0:v:0",
                  "-vf",
                  fmt::format("fps={:.6f}", wanted / info.seconds),
                  "-pix_fmt",
                  "yuvj420p",
                  "-q:v",
                  "2",
                  "-f",
                  "image2",
                  NumberedFiles(fs::absolute(all))};
  request.errors_apart = true;
  request.on_line = [&](const std::string& line) {
    int done = 0;
    if (std::sscanf(line.c_str(), "frame=%d", &done) == 1) {
      listener(StepDone{"import", std::min<int64_t>(done, total), total, "frames", "looking for sharp ones"});
    }
  };
  request.stall_limit = StallLimit();
  const ProcessResult result = RunProcess(request);
  RequireUndisturbed(video, result);
  const std::vector<fs::path> candidates = Candidates(all);
  if (result.exit_code != 0) {
    if (result.last_error.find("No space left") != std::string::npos) {
      throw RunError("{}: cannot be written: {}", all.string(), SystemReason(ENOSPC));
    }
    RefuseVideo(video, result.last_error);
  }
  if (candidates.size() < kMinFrames) RefuseVideo(video, fmt::format("{} frames could be decoded", candidates.size()));
  if (!result.last_error.empty()) {
    listener(Warning{fmt::format("{}: is damaged in places ({}); frames from there may be, too", video.string(),
                                 Printable(result.last_error))});
  }
  std::vector<double> sharpness(candidates.size());
  ParallelFor(static_cast<int64_t>(candidates.size()), [&](int64_t i) {
    ThrowIfInterrupted();
    const auto index = static_cast<size_t>(i);
    sharpness[index] = Sharpness(ReadGrayThumbnail(candidates[index], kSharpnessSide));
  });
  const size_t parts = std::min(candidates.size(), static_cast<size_t>(frames));
  for (size_t part = 0; part < parts; ++part) {
    const size_t begin = part * candidates.size() / parts, end = (part + 1) * candidates.size() / parts;
    const auto first = sharpness.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto best = std::max_element(first, sharpness.begin() + static_cast<std::ptrdiff_t>(end));
    const auto index = static_cast<size_t>(best - sharpness.begin());
    fs::rename(candidates[index], dir / fmt::format("frame_{:04}.jpg", part + 1), error);
    if (error) throw RunError("{}: cannot be renamed: {}", candidates[index].string(), SystemReason(error));
  }
  fs::remove_all(all, error);
  if (error) throw RunError("{}: cannot be removed: {}", all.string(), SystemReason(error));
}

}  // namespace oraclegs
