#include "oraclegs/capture/video.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdio>
#include <iterator>
#include <nlohmann/json.hpp>
#include <system_error>

#include "oraclegs/capture/photo_checks.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/subprocess.h"
#include "oraclegs/core/text.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/image/image.h"
#include "oraclegs/image/read_image.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr int kCandidates = 5;  // frames looked at for each that is taken
constexpr int kMinFrames = 3;
constexpr int kSharpnessSide = 960;
constexpr std::chrono::duration<double> kProbeLimit{60};
constexpr int kTicks = 25;  // a second, of the frames that are taken: times in the file are not believed
// ffmpeg finds the format by content: a playlist that is called .mp4 would name other files of this machine.
constexpr char kFormats[] = "mov,mp4,m4a,3gp,3g2,mj2,matroska,webm,avi,mpegts,mpeg,mpegvideo,asf,flv,ogg";

/// Arguments of ffprobe and ffmpeg: this video, which is neither an option nor an address, and nothing that it names.
std::vector<std::string> InputArguments(const fs::path& video) {
  return {"-protocol_whitelist",
          "file",
          "-format_whitelist",
          kFormats,
          "-max_pixels",
          std::to_string(1'000'000 * kLargestMaxMegapixels),
          "-i",
          "file:" + fs::absolute(video).string()};
}

void Append(std::vector<std::string> arguments, std::vector<std::string>* argv) {
  argv->insert(argv->end(), std::make_move_iterator(arguments.begin()), std::make_move_iterator(arguments.end()));
}

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
  std::string head = ReadHead(path, 16);
  head.resize(16);
  const std::string_view bytes = head;
  return (bytes.substr(4, 4) == "ftyp" && !IsHeif(bytes)) || bytes.starts_with("\x1A\x45\xDF\xA3") ||
         (bytes.starts_with("RIFF") && bytes.substr(8, 4) == "AVI ");
}

int64_t ParseProbe(std::string_view output, const fs::path& video) {
  const size_t begin = output.find('{'), end = output.rfind('}');
  if (begin == std::string::npos || end == std::string::npos || end < begin) RefuseVideo(video, "");
  const nlohmann::json probed = ParseJsonOrDiscard(output.substr(begin, end - begin + 1));
  if (!probed.is_object() || !probed.contains("streams") || !probed["streams"].is_array() ||
      probed["streams"].empty() || !probed["streams"][0].is_object()) {
    RefuseVideo(video, "no picture track");
  }
  const nlohmann::json packets = probed["streams"][0].value("nb_read_packets", nlohmann::json());
  const std::string text = packets.is_string() ? packets.get<std::string>() : "";
  int64_t frames = 0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), frames);
  if (error != std::errc() || rest != text.data() + text.size()) frames = 0;
  if (frames < kMinFrames) {
    throw InputError("{}: is too short, with {} frames; film ten seconds or more while you walk around", video.string(),
                     std::max<int64_t>(frames, 0));
  }
  return frames;
}

int64_t ProbeVideo(const fs::path& video) {
  RequireFfmpeg(video);
  std::error_code error;
  if (fs::is_regular_file(video, error) && fs::file_size(video, error) == 0) {
    throw InputError("{}: is empty; copy the video again", video.string());
  }
  std::string json;
  ProcessRequest request;
  request.argv = {
      "ffprobe", "-v",  "error", "-select_streams", "v:0", "-count_packets", "-show_entries", "stream=nb_read_packets",
      "-of",     "json"};
  Append(InputArguments(video), &request.argv);
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
  const int64_t in_video = ProbeVideo(video);
  const fs::path all = dir / "candidates";
  std::error_code error;
  fs::create_directories(all, error);
  if (error) throw RunError("{}: cannot be made: {}", all.string(), SystemReason(error));

  const int64_t total = std::min(int64_t{frames} * kCandidates, in_video);
  ProcessRequest request;
  request.argv = {"ffmpeg", "-nostdin", "-hide_banner", "-loglevel", "error", "-progress", "pipe:1"};
  Append(InputArguments(video), &request.argv);
  Append(
      {"-map", "0:v:0", "-vf",
       fmt::format("select=gt(floor((n+1)*{0}/{1})\\,floor(n*{0}/{1})),settb=1/{2},setpts=N", total, in_video, kTicks),
       "-r", std::to_string(kTicks), "-frames:v", std::to_string(total), "-pix_fmt", "yuvj420p", "-q:v", "2", "-f",
       "image2", NumberedFiles(fs::absolute(all))},
      &request.argv);
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
