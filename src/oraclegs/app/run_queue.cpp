#include "oraclegs/app/run_queue.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <system_error>

#include "oraclegs/app/project_state.h"
#include "oraclegs/app/uploads.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kLook(300);
constexpr size_t kMinPhotos = 3;

bool IsBusy(const Project& project) { return StateOf(project.record.process) != ProgramState::kGone; }

bool Waits(const Project& project) { return project.record.queued > 0 && project.problem.empty(); }

/// An error in words for people who see the page and no file.
std::string InPlainWords(const std::string& error) {
  for (const int full : {ENOSPC, EDQUOT}) {
    if (error.find(SystemReason(full)) == std::string::npos) continue;
    return "The disk is full. Make room there, then press “Try again”.";
  }
  return error;
}

/// The project whose turn it is: none while another one runs.
std::optional<Project> NextOf(std::vector<Project> projects) {
  if (std::any_of(projects.begin(), projects.end(), IsBusy)) return std::nullopt;
  std::erase_if(projects, [](const Project& project) { return !Waits(project); });
  const auto next = std::min_element(projects.begin(), projects.end(), [](const Project& a, const Project& b) {
    return a.record.queued < b.record.queued;
  });
  if (next == projects.end()) return std::nullopt;
  return *next;
}

}  // namespace

std::vector<std::string> ReconstructArgv(const fs::path& program, const Project& project) {
  std::vector<std::string> argv = {program.string(), "reconstruct"};
  bool photos = false;
  for (const Upload& upload : UploadsOf(project.paths)) {
    if (upload.kind == UploadKind::kPhoto && !std::exchange(photos, true)) argv.push_back(project.paths.photos());
    if (upload.kind != UploadKind::kPhoto) argv.push_back(upload.path.string());
  }
  argv.insert(argv.end(), {"--out", project.paths.splat().string(), "--quality", project.record.quality, "--device",
                           project.record.device});
  return argv;
}

RunQueue::RunQueue(fs::path program, Library* library)
    : program_(std::move(program)), library_(library), thread_([this] { Work(); }) {}

RunQueue::~RunQueue() {
  {
    const std::lock_guard guard(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void RunQueue::Add(const Project& project, const std::string& quality, const std::string& device) {
  const std::vector<Upload> uploads = UploadsOf(project.paths);
  const bool media = std::any_of(uploads.begin(), uploads.end(),
                                 [](const Upload& upload) { return upload.kind != UploadKind::kPhoto; });
  if (!media && uploads.size() < kMinPhotos) {
    throw InputError("a splat needs at least three photos of the same thing; twelve or more are better");
  }
  const std::lock_guard guard(mutex_);
  int64_t last = 0;
  for (const Project& other : library_->Projects()) last = std::max(last, other.record.queued);
  library_->Update(project.id, [&](ProjectRecord* record) {
    record->queued = last + 1, record->quality = quality, record->device = device;
  });
  library_->SetProblem(project.id, "");
  wake_.notify_all();
}

void RunQueue::Stop(const Project& project) {
  const std::lock_guard guard(mutex_);
  library_->Update(project.id, [](ProjectRecord* record) { record->queued = 0; });
  const auto now = library_->Find(project.id);  // it may have been started a moment ago
  const ProcessMark process = now ? now->record.process : ProcessMark();
  if (StateOf(process) == ProgramState::kPaused) SignalSession(process, SIGCONT);
  SignalProgram(process, SIGINT);
}

bool RunQueue::Pause(const Project& project) {
  return StateOf(project.record.process) == ProgramState::kRuns && SignalSession(project.record.process, SIGSTOP);
}

bool RunQueue::Resume(const Project& project) {
  return StateOf(project.record.process) == ProgramState::kPaused && SignalSession(project.record.process, SIGCONT);
}

int RunQueue::PositionOf(const Project& project) const {
  if (!Waits(project)) return 0;
  int position = 1;
  for (const Project& other : library_->Projects()) {
    if (Waits(other) && other.record.queued < project.record.queued) ++position;
  }
  return position;
}

void RunQueue::StartNext() {
  const std::optional<Project> next = NextOf(library_->Projects());
  if (!next) return;
  ProcessMark process;
  try {
    // Nothing starts whose record cannot be written: nobody would find it again.
    library_->Update(next->id, [](ProjectRecord* record) { record->started = true; });
    std::error_code ignored;
    fs::remove(next->paths.log(), ignored);
    try {
      process = StartDetached(ReconstructArgv(program_, *next), next->paths.log());
    } catch (const Error& error) {  // shown as the run's own
      WriteFileAtomically(next->paths.log(), fmt::format("error: {}\n", error.what()));
    }
    library_->Update(next->id, [&](ProjectRecord* record) { record->queued = 0, record->process = process; });
  } catch (const Error& error) {  // and is not tried again and again
    SignalSession(process, SIGKILL);
    library_->SetProblem(next->id, InPlainWords(error.what()));
  }
}

void RunQueue::Work() {
  std::unique_lock lock(mutex_);
  while (!stop_) {
    try {
      StartNext();
    } catch (const std::exception&) {  // the library cannot be read: once more in a moment
    }
    wake_.wait_for(lock, kLook);
  }
}

}  // namespace oraclegs
