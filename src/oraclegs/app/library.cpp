#include "oraclegs/app/library.h"

#include <algorithm>
#include <cctype>
#include <system_error>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/subprocess.h"
#include "oraclegs/core/text.h"
#include "oraclegs/web/file_below.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMaxFolderName = 40;

/// A folder's name for a title: letters, digits and single hyphens.
std::string FolderNameOf(const std::string& title) {
  std::string name;
  for (const char c : title) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80 && std::isalnum(byte) != 0) {
      name += static_cast<char>(std::tolower(byte));
    } else if (!name.empty() && name.back() != '-') {
      name += '-';
    }
    if (name.size() >= kMaxFolderName) break;
  }
  while (!name.empty() && name.back() == '-') name.pop_back();
  return name.empty() ? "splat" : name;
}

bool IsRegular(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(fs::symlink_status(path, ignored));
}

/// The project in a folder of the library; nothing for other folders.
std::optional<Project> ProjectIn(const fs::path& folder) {
  std::error_code ignored;
  const std::string name = folder.filename().string();
  if (!fs::is_directory(fs::symlink_status(folder, ignored)) || !IsPlainPath(name) || name.front() == '.') return {};
  Project project{IdOf(name), ProjectPaths(folder), false, {}, ""};
  if (IsRegular(project.paths.record())) {
    project.record = ReadProjectRecord(project.paths);
    return project;
  }
  if (!IsRegular(folder / "options.json") || !IsRegular(folder / "stages.json")) return {};
  project.is_foreign = true;
  project.record.name = OneLine(name);
  return project;
}

}  // namespace

std::string IdOf(const std::string& name) {
  uint64_t hash = 0xcbf29ce484222325;  // FNV-1a
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return fmt::format("{:016x}", hash);
}

Library::Library(fs::path root) : root_(std::move(root)) {
  RequireWritableFolder(root_);
  root_ = fs::canonical(root_);
  lock_.emplace(root_);
  if (lock_->state() == FolderLock::State::kHeldByAnother) {
    throw RunError("{}: another OracleGS shows this library already ({}); use its page, or another --library",
                   root_.string(), lock_->holder());
  }
}

std::vector<Project> Library::Projects() const {
  const std::lock_guard guard(mutex_);
  std::vector<Project> projects;
  std::error_code error;
  for (fs::directory_iterator it(root_, error), end; !error && it != end; it.increment(error)) {
    if (auto project = In(it->path())) projects.push_back(std::move(*project));
  }
  std::sort(projects.begin(), projects.end(),
            [](const Project& a, const Project& b) { return a.paths.root() < b.paths.root(); });
  return projects;
}

std::optional<Project> Library::Find(const std::string& id) const {
  const std::lock_guard guard(mutex_);
  std::error_code error;
  for (fs::directory_iterator it(root_, error), end; !error && it != end; it.increment(error)) {
    if (IdOf(it->path().filename().string()) == id) return In(it->path());
  }
  return std::nullopt;
}

Project Library::Create(const std::string& name) {
  const std::lock_guard guard(mutex_);
  Project project{"", ProjectPaths(""), false, {}, ""};
  project.record.name = CleanName(name);
  const std::string base = FolderNameOf(project.record.name);
  std::error_code error;
  for (int i = 1;; ++i) {
    const fs::path folder = root_ / (i == 1 ? base : fmt::format("{}-{}", base, i));
    const bool made = fs::create_directory(folder, error);
    if (error) throw RunError("{}: cannot be made: {}", folder.string(), SystemReason(error));
    if (!made) continue;
    project.id = IdOf(folder.filename().string());
    project.paths = ProjectPaths(folder);
    break;
  }
  fs::permissions(project.paths.root(), fs::perms::owner_all, error);
  WriteProjectRecord(project.paths, project.record);
  return project;
}

void Library::Update(const std::string& id, const std::function<void(ProjectRecord*)>& change) {
  const std::optional<Project> project = Find(id);
  if (!project || project->is_foreign) throw InputError("there is no such project any more");
  const std::lock_guard guard(mutex_);
  ProjectRecord record = ReadProjectRecord(project->paths);
  change(&record);
  WriteProjectRecord(project->paths, record);
}

void Library::SetProblem(const std::string& id, const std::string& problem) {
  const std::lock_guard guard(mutex_);
  problems_[id] = problem;
}

std::optional<Project> Library::In(const fs::path& folder) const {
  std::optional<Project> project = ProjectIn(folder);
  if (!project) return project;
  const auto found = problems_.find(project->id);
  if (found != problems_.end()) project->problem = found->second;
  return project;
}

bool Library::Trash(const Project& project) const {
  if (FindProgram("gio").empty()) return false;
  return RunProcess({"gio", "trash", "--", project.paths.root().string()}).exit_code == 0;
}

void Library::Remove(const Project& project) const {
  std::error_code error;
  fs::remove_all(project.paths.root(), error);
  if (error) throw RunError("{}: cannot be removed: {}", project.paths.root().string(), SystemReason(error));
}

uint64_t Library::FreeBytes() const {
  std::error_code error;
  const fs::space_info space = fs::space(root_, error);
  return error ? 0 : space.available;
}

}  // namespace oraclegs
