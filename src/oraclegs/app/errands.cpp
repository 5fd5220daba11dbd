#include "oraclegs/app/errands.h"

#include <algorithm>
#include <chrono>
#include <system_error>

#include "oraclegs/core/error.h"
#include "oraclegs/core/subprocess.h"
#include "oraclegs/core/text.h"
#include "oraclegs/core/unique_json.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr double kCountAgain = 20;  // seconds between two counts of a folder's bytes

/// Thrown where the app ends before an errand does.
struct Stopped {};

double Now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

uint64_t BytesBelow(const fs::path& folder) {
  uint64_t bytes = 0;
  std::error_code error;
  for (fs::recursive_directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    std::error_code gone;
    if (it->is_regular_file(gone) && !it->is_symlink(gone)) bytes += it->file_size(gone);
  }
  return bytes;
}

/// The line that says why a program of ours failed.
std::string ReasonOf(const ProcessResult& result) {
  std::string reason = OneLine(result.last_error);
  if (reason.starts_with("error: ")) reason.erase(0, 7);
  return reason.empty() ? fmt::format("it ended with code {}", result.exit_code) : reason;
}

ProcessRequest RequestOf(std::vector<std::string> argv, const std::atomic<bool>& stop) {
  ProcessRequest request{.argv = std::move(argv), .errors_apart = true};
  request.while_running = [&stop] {
    if (stop) throw Stopped();
  };
  return request;
}

Errands::Outcome CheckPhotos(const fs::path& program, const ProjectPaths& paths, const std::atomic<bool>& stop) {
  std::string text;
  ProcessRequest request =
      RequestOf({program.string(), "info", paths.photos().string(), "--check", "--json", "--quiet"}, stop);
  request.on_line = [&](const std::string& line) { text += line + "\n"; };
  const ProcessResult result = RunProcess(request);
  if (result.exit_code != 0) return {"failed", ReasonOf(result), {}};
  const size_t begin = text.find('{');
  return {"done", "", ParseJsonOrDiscard(begin == std::string::npos ? "" : text.substr(begin))};
}

/// The film of a run, which it made itself.
Errands::Outcome CopyFilm(const Project& project, const fs::path& file) {
  std::error_code error;
  const fs::path film = project.splat() / "renders" / "orbit" / "video.mp4";
  if (!fs::exists(film, error)) return {"failed", "the run made no film: ffmpeg is not installed", {}};
  fs::copy_file(film, file, fs::copy_options::overwrite_existing, error);
  if (error) return {"failed", "the film cannot be copied: " + SystemReason(error), {}};
  return {"done", "", {}};
}

std::string CheckKey(const std::string& project) { return project + "/check"; }
std::string ExportKey(const std::string& project, const ExportFormat& format) {
  return project + "/export/" + format.id;
}

}  // namespace

const std::vector<ExportFormat>& ExportFormats() {
  static const std::vector<ExportFormat> formats = {{"spz", "SPZ: small, for most viewers", ".spz"},
                                                    {"glb", "GLB: for 3D programs and the web", ".glb"},
                                                    {"ply", "PLY: for editors such as SuperSplat", ".ply"},
                                                    {"sog", "SOG: smallest, for PlayCanvas", ".sog"},
                                                    {"usdz", "USD: for Apple and film programs", ".usdz"},
                                                    {"mesh", "Mesh: triangles with a texture (GLB)", " mesh.glb"},
                                                    {"film", "Film: a flight around it (MP4)", ".mp4"}};
  return formats;
}

const ExportFormat* FindExportFormat(const std::string& id) {
  const auto& formats = ExportFormats();
  const auto found = std::find_if(formats.begin(), formats.end(), [&](const auto& format) { return id == format.id; });
  return found == formats.end() ? nullptr : &*found;
}

fs::path ExportFile(const Project& project, const ExportFormat& format) {
  return project.paths.exports() / (project.paths.root().filename().string() + format.extension);
}

std::vector<std::string> ExportArgv(const fs::path& program, const Project& project, const ExportFormat& format,
                                    const fs::path& file) {
  std::vector<std::string> argv = {program.string(), "export", project.splat().string(), "--out", file.string()};
  const std::vector<std::string> edits = EditArguments(project.record.edits);
  if (std::string(format.id) == "mesh") {
    argv[1] = "mesh";
    const std::string& crop = project.record.edits.crop;
    if (crop != "none") argv.insert(argv.end(), {"--crop", crop});
  } else {
    argv.insert(argv.end(), edits.begin(), edits.end());
  }
  argv.emplace_back("--quiet");
  return argv;
}

Errands::Errands(fs::path program) : program_(std::move(program)), thread_([this] { Work(); }) {}

Errands::~Errands() {
  {
    const std::lock_guard guard(mutex_);  // or the thread could begin to wait just now, for ever
    stop_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void Errands::Ask(Task task) {
  const std::lock_guard guard(mutex_);
  outcomes_[task.key] = {"running", "", {}};
  std::erase_if(tasks_, [&](const Task& other) { return other.key == task.key; });
  tasks_.push_back(std::move(task));
  wake_.notify_all();
}

Errands::Outcome Errands::Find(const std::string& key) const {
  const std::lock_guard guard(mutex_);
  const auto found = outcomes_.find(key);
  return found == outcomes_.end() ? Outcome() : found->second;
}

void Errands::Check(const Project& project) {
  constexpr std::chrono::seconds kQuiet(1);
  Ask({CheckKey(project.id), [this, paths = project.paths] { return CheckPhotos(program_, paths, stop_); },
       Clock::now() + kQuiet});
}

Errands::Outcome Errands::CheckOf(const std::string& project) const { return Find(CheckKey(project)); }

void Errands::Export(const Project& project, const ExportFormat& format) {
  Ask({ExportKey(project.id, format), [this, project, &format]() -> Outcome {
         const fs::path file = ExportFile(project, format);
         std::error_code error;
         fs::create_directories(file.parent_path(), error);
         if (std::string(format.id) == "film") return CopyFilm(project, file);
         const ProcessResult result = RunProcess(RequestOf(ExportArgv(program_, project, format, file), stop_));
         if (result.exit_code != 0) return {"failed", ReasonOf(result), {}};
         return {"done", "", {}};
       }});
}

Errands::Outcome Errands::ExportOf(const std::string& project, const ExportFormat& format) const {
  return Find(ExportKey(project, format));
}

void Errands::Forget(const std::string& project) {
  const std::lock_guard guard(mutex_);
  std::erase_if(outcomes_, [&](const auto& entry) { return entry.first.starts_with(project + "/"); });
}

void Errands::ForgetExport(const std::string& project, const ExportFormat& format) {
  const std::lock_guard guard(mutex_);
  outcomes_.erase(ExportKey(project, format));
}

uint64_t Errands::BytesOf(const Project& project) {
  {
    const std::lock_guard guard(mutex_);
    auto& [bytes, counted] = sizes_[project.id];
    if (Now() - counted < kCountAgain) return bytes;
    counted = Now();
  }
  Ask({project.id + "/bytes", [this, id = project.id, root = project.paths.root()]() -> Outcome {
         const uint64_t bytes = BytesBelow(root);
         const std::lock_guard guard(mutex_);
         sizes_[id] = {bytes, Now()};
         return {"done", "", {}};
       }});
  const std::lock_guard guard(mutex_);
  return sizes_[project.id].first;
}

void Errands::Work() {
  std::unique_lock lock(mutex_);
  while (true) {
    if (stop_) return;
    const auto next =
        std::min_element(tasks_.begin(), tasks_.end(), [](const Task& a, const Task& b) { return a.due < b.due; });
    if (next == tasks_.end()) {
      wake_.wait(lock);
      continue;
    }
    if (const Clock::time_point due = next->due; due > Clock::now()) {
      wake_.wait_until(lock, due);
      continue;
    }
    const Task task = std::move(*next);
    tasks_.erase(next);
    lock.unlock();
    Outcome outcome;
    try {
      outcome = task.work();
    } catch (const std::exception& error) {
      outcome = {"failed", OneLine(error.what()), {}};
    } catch (const Stopped&) {
      outcome = {"failed", "OracleGS was ended", {}};
    }
    lock.lock();
    const bool again =
        std::any_of(tasks_.begin(), tasks_.end(), [&](const Task& other) { return other.key == task.key; });
    const auto known = outcomes_.find(task.key);  // forgotten meanwhile: the result is of what was before
    if (!again && known != outcomes_.end()) known->second = std::move(outcome);
  }
}

}  // namespace oraclegs
