#include "oraclegs/app/documents.h"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <ctime>
#include <map>
#include <system_error>

#include "oraclegs/app/json_parts.h"
#include "oraclegs/app/uploads.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/web/file_below.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr size_t kLogLines = 60;

/// Time of change of a file, seconds since 1970; 0 where there is none.
int64_t ChangeOf(const fs::path& file) {
  std::error_code error;
  const fs::file_time_type time = fs::last_write_time(file, error);
  if (error) return 0;
  return std::chrono::duration_cast<std::chrono::seconds>(std::chrono::file_clock::to_sys(time).time_since_epoch())
      .count();
}

int64_t ChangeOf(const Project& project) {
  return std::max({ChangeOf(project.paths.record()), ChangeOf(project.splat() / "live" / "state.json"),
                   ChangeOf(project.splat() / "point_cloud.ply"), ChangeOf(project.paths.photos())});
}

std::string UtcText(int64_t seconds) {
  const auto time = static_cast<std::time_t>(seconds);
  std::tm utc{};
  gmtime_r(&time, &utc);
  char text[32] = "";
  std::strftime(text, sizeof(text), "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

/// The first render, or else image, of a run's document that can be shown; empty without one.
std::string PictureIn(const nlohmann::json& document) {
  const nlohmann::json views = ListIn(document, "views");
  for (const char* part : {"render", "image"}) {
    for (const nlohmann::json& view : views) {
      const nlohmann::json image = view.is_object() ? view.value(part, nlohmann::json()) : nlohmann::json();
      if (std::string url = TextIn(image, "url"); IsPlainPath(url)) return url;
    }
  }
  return "";
}

/// An image to stand for the project: of its run, else a small enough photo, else null.
nlohmann::json PictureOf(const Project& project, const std::vector<Upload>& uploads, Pictures* pictures) {
  constexpr uint64_t kMaxPictureBytes = 12 << 20;
  const std::string base = "projects/" + project.id;
  if (const std::string path = pictures->Of(project); !path.empty()) return base + "/files/" + path;
  for (const Upload& upload : uploads) {
    std::string end = upload.path.extension().string();
    std::transform(end.begin(), end.end(), end.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    const bool shown = end == ".jpg" || end == ".jpeg" || end == ".png" || end == ".webp";
    if (shown && upload.bytes <= kMaxPictureBytes) return base + "/photos/" + upload.id;
  }
  return nullptr;
}

nlohmann::json StagesOf(const nlohmann::json& live) {
  nlohmann::json stages = nlohmann::json::array();
  for (const nlohmann::json& stage : ListIn(live, "stages")) {
    const std::string state = TextIn(stage, "state");
    const bool planned = state == "planned";
    const nlohmann::json left = stage.is_object() ? stage.value("eta_seconds", nlohmann::json()) : nlohmann::json();
    stages.push_back({{"label", StageInWords(TextIn(stage, "name"))},
                      {"state", planned              ? "todo"
                                : state == "running" ? "running"
                                                     : "done"},
                      {"seconds", planned ? nlohmann::json() : nlohmann::json(NumberIn(stage, "seconds"))},
                      {"seconds_left", planned ? nlohmann::json(NumberIn(stage, "seconds")) : left}});
  }
  return stages;
}

/// How far a run is; null for one that is at rest.
nlohmann::json ProgressOf(const ProjectState& state, int position) {
  if (IsAtRest(state.phase) || state.phase == ProjectPhase::kElsewhere) return nullptr;
  nlohmann::json progress = {{"stage", ""}, {"share", 0}, {"seconds_left", nullptr}, {"position", position}};
  if (state.phase == ProjectPhase::kWaiting) return progress;
  const nlohmann::json stages = ListIn(state.live, "stages");
  if (TextIn(state.live, "state") != "running") {  // of the run before: this one has not begun to write
    progress["stage"] = "Starting";
    return progress;
  }
  for (const nlohmann::json& stage : stages) {
    if (TextIn(stage, "state") == "running") progress["stage"] = StageInWords(TextIn(stage, "name"));
  }
  const double elapsed = NumberIn(state.live, "elapsed_seconds"), left = NumberIn(state.live, "left_seconds");
  if (left > 0) {
    progress["seconds_left"] = left;
    progress["share"] = std::clamp(elapsed / (elapsed + left), 0.0, 1.0);
  }
  return progress;
}

std::vector<std::string> AllowedOf(const Project& project, const ProjectState& state) {
  std::error_code ignored;
  const bool splat = fs::exists(project.splat() / "point_cloud.ply", ignored);
  const bool at_rest = IsAtRest(state.phase);
  std::vector<std::string> can;
  const auto add = [&](bool allowed, const char* what) {
    if (allowed) can.emplace_back(what);
  };
  const bool own = !project.is_foreign;
  add(own && at_rest, "start");
  add(own && at_rest, "upload");
  add(own && state.phase == ProjectPhase::kRunning, "pause");
  add(own && state.phase == ProjectPhase::kPaused, "resume");
  add(own && !at_rest && state.phase != ProjectPhase::kElsewhere, "stop");
  add(own, "rename");
  add(at_rest, "delete");
  add(own && at_rest && splat, "export");
  add(own && at_rest && splat, "edit");
  add(!state.live.is_null() || splat, "view");
  add(fs::exists(project.splat() / "report.html", ignored), "report");
  return can;
}

nlohmann::json SummaryOf(const AppParts& parts, const Project& project, const ProjectState& state,
                         const std::vector<Upload>& uploads) {
  return {{"id", project.id},
          {"name", project.record.name},
          {"state", PhaseWord(state.phase)},
          {"message", state.message},
          {"photos", uploads.size()},
          {"bytes", parts.errands->BytesOf(project)},
          {"changed", UtcText(ChangeOf(project))},
          {"picture", PictureOf(project, uploads, parts.pictures)},
          {"progress", ProgressOf(state, parts.queue.PositionOf(project))},
          {"can", AllowedOf(project, state)}};
}

nlohmann::json FilesOf(const std::vector<Upload>& uploads) {
  nlohmann::json files = nlohmann::json::array();
  for (const Upload& upload : uploads) {
    const char* kind = upload.kind == UploadKind::kPhoto ? "photo" : upload.kind == UploadKind::kZip ? "zip" : "video";
    files.push_back(
        {{"id", upload.id}, {"name", upload.path.filename().string()}, {"bytes", upload.bytes}, {"kind", kind}});
  }
  return files;
}

/// Whether a sentence names a file: not "11.jpg" where it is "1.jpg".
bool Names(const std::string& text, const std::string& name) {
  const auto belongs = [&](size_t at) {
    return at < text.size() && (std::isalnum(static_cast<unsigned char>(text[at])) != 0 || text[at] == '_');
  };
  for (size_t at = text.find(name); at != std::string::npos; at = text.find(name, at + 1)) {
    if ((at == 0 || !belongs(at - 1)) && !belongs(at + name.size())) return true;
  }
  return false;
}

/// Sentences about the photos, each with the files that it names.
nlohmann::json CheckOf(const Errands::Outcome& outcome, const std::vector<Upload>& uploads) {
  nlohmann::json warnings = nlohmann::json::array();
  const auto add = [&](const std::string& text) {
    nlohmann::json named = nlohmann::json::array();
    for (const Upload& upload : uploads) {
      if (Names(text, upload.path.filename().string())) named.push_back(upload.id);
    }
    warnings.push_back({{"text", text}, {"files", named}});
  };
  for (const nlohmann::json& text : ListIn(outcome.result, "warnings")) {
    if (text.is_string()) add(text.get<std::string>());
  }
  if (outcome.state == "failed" && !outcome.message.empty()) add(outcome.message);
  const std::string state = outcome.state == "failed" ? "done" : outcome.state;
  return {{"state", state}, {"warnings", warnings}};
}

nlohmann::json ExportsOf(const Project& project, const Errands& errands) {
  nlohmann::json exports = nlohmann::json::array();
  for (const ExportFormat& format : ExportFormats()) {
    const Errands::Outcome outcome = errands.ExportOf(project.id, format);
    const fs::path file = ExportFile(project, format);
    std::error_code error;
    const uintmax_t bytes = fs::file_size(file, error);
    const std::string state = outcome.state == "none" ? (error ? "" : "done") : outcome.state;
    if (state.empty()) continue;
    exports.push_back({{"id", format.id},
                       {"name", project.record.name + format.extension},
                       {"bytes", error ? 0 : bytes},
                       {"format", format.id},
                       {"state", state},
                       {"message", outcome.message}});
  }
  return exports;
}

/// metrics.json of a run; null where it has none.
nlohmann::json MetricsOf(const Project& project) {
  try {
    return ParseJsonOrDiscard(ReadFile(project.splat() / "metrics.json", 16 << 20));
  } catch (const std::exception&) {  // not measured yet
    return nullptr;
  }
}

/// For each quality the seconds that this many photos take here, by what finished runs took for each of theirs (their
/// median), and the most memory that one took. Qualities without a run are left out.
nlohmann::json EstimatesOf(const AppParts& parts, const Project& project, size_t photos) {
  struct Taken {
    std::vector<double> seconds_per_photo;
    double memory = 0;
  };
  std::map<std::string, Taken> taken;
  for (const Project& other : parts.library.Projects()) {
    if (other.is_foreign || other.id == project.id) continue;
    const ProjectState state = StateOf(other);
    const auto count = static_cast<double>(UploadsOf(other.paths).size());
    const double seconds = NumberIn(state.live, "elapsed_seconds");
    if (state.phase != ProjectPhase::kFinished || count <= 0 || seconds <= 0) continue;
    Taken& of_quality = taken[other.record.quality];
    of_quality.seconds_per_photo.push_back(seconds / count);
    of_quality.memory = std::max(of_quality.memory, NumberIn(MetricsOf(other), "peak_memory_bytes"));
  }
  nlohmann::json estimates = nlohmann::json::object();
  for (auto& [quality, of_quality] : taken) {
    std::vector<double>& each = of_quality.seconds_per_photo;
    const auto middle = each.begin() + static_cast<ptrdiff_t>(each.size() / 2);
    std::nth_element(each.begin(), middle, each.end());
    estimates[quality] = {
        {"seconds", std::round(*middle * static_cast<double>(photos))},
        {"memory_bytes", of_quality.memory > 0 ? nlohmann::json(of_quality.memory) : nlohmann::json()}};
  }
  return estimates;
}

nlohmann::json ScoresOf(const Project& project) {
  const nlohmann::json metrics = MetricsOf(project);
  const nlohmann::json test = metrics.is_object() ? metrics.value("test", nlohmann::json()) : nlohmann::json();
  if (NumberIn(test, "psnr") > 0) return {{"psnr", NumberIn(test, "psnr")}};
  return nullptr;
}

nlohmann::json ChoicesOf(const std::vector<AppChoice>& choices) {
  nlohmann::json list = nlohmann::json::array();
  for (const AppChoice& choice : choices) list.push_back({{"id", choice.id}, {"label", choice.label}});
  return list;
}

}  // namespace

std::string Pictures::Of(const Project& project) {
  const auto file = FileBelow::Open(project.splat(), "report/run.json");
  if (!file) return "";
  const std::lock_guard guard(mutex_);
  Known& known = known_[project.id];
  if (known.version == file->tag()) return known.path;
  constexpr uint64_t kMaxBytes = 64 << 20;
  known = {file->tag(), PictureIn(ParseJsonOrDiscard(file->ReadAll(kMaxBytes).value_or("")))};
  return known.path;
}

nlohmann::json LibraryDocument(const AppParts& parts) {
  struct Dated {
    int64_t changed;
    nlohmann::json summary;
  };
  std::vector<Dated> dated;
  for (const Project& project : parts.library.Projects()) {
    dated.push_back({ChangeOf(project), SummaryOf(parts, project, StateOf(project), UploadsOf(project.paths))});
  }
  std::stable_sort(dated.begin(), dated.end(), [](const Dated& a, const Dated& b) { return a.changed > b.changed; });
  nlohmann::json projects = nlohmann::json::array();
  for (Dated& entry : dated) projects.push_back(std::move(entry.summary));
  nlohmann::json formats = nlohmann::json::array();
  for (const ExportFormat& format : ExportFormats()) formats.push_back({{"id", format.id}, {"label", format.label}});
  constexpr uint64_t kTooLittle = uint64_t{2} << 30, kStep = 100 << 20;
  const uint64_t free = parts.library.FreeBytes();
  return {{"folder", parts.library.root().string()},
          {"free_bytes", free / kStep * kStep},  // in steps, or the document would change all the time
          {"problem",
           free > kTooLittle ? "" : "The disk is nearly full. Delete a project, or choose a library on another disk."},
          {"formats", formats},
          {"qualities", ChoicesOf(parts.choices.qualities)},
          {"default_quality", parts.choices.quality},
          {"devices", ChoicesOf(parts.choices.devices)},
          {"projects", projects}};
}

nlohmann::json ProjectDocument(const AppParts& parts, const Project& project) {
  const ProjectState state = StateOf(project);
  const std::vector<Upload> uploads = UploadsOf(project.paths);
  nlohmann::json document = SummaryOf(parts, project, state, uploads);
  document["quality"] = project.record.quality;
  document["files"] = FilesOf(uploads);
  document["check"] = CheckOf(parts.errands->CheckOf(project.id), uploads);
  document["stages"] = StagesOf(state.live);
  document["warnings"] = ListIn(state.live, "warnings");
  document["log"] = LastLines(project.paths, kLogLines);
  document["scores"] = ScoresOf(project);
  if (IsAtRest(state.phase)) document["estimates"] = EstimatesOf(parts, project, uploads.size());
  document["edits"] = EditsToJson(project.record.edits);
  document["exports"] = ExportsOf(project, *parts.errands);
  return document;
}

}  // namespace oraclegs
