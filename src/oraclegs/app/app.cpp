#include "oraclegs/app/app.h"

#include <algorithm>
#include <atomic>
#include <map>
#include <mutex>
#include <system_error>
#include <utility>

#include "oraclegs/app/requests.h"
#include "oraclegs/app/session.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/text.h"
#include "oraclegs/web/site.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxUploadsAtOnce = 8;
constexpr size_t kMaxProjects = 2000;

std::string Chosen(const nlohmann::json& body, const char* key, const std::string& usual,
                   const std::vector<AppChoice>& choices) {
  std::string text = TextAsked(body, key, usual);
  const bool known = std::any_of(choices.begin(), choices.end(), [&](const AppChoice& c) { return c.id == text; });
  if (!known) throw Refusal{400, fmt::format("{}: there is no such choice", key)};
  return text;
}

/// Counts uploads that go on.
class UploadSlot {
 public:
  explicit UploadSlot(std::atomic<int>* count) : count_(count) {
    if (++*count_ <= kMaxUploadsAtOnce) return;
    --*count_;
    throw Refusal{429, "too many files are sent at once; try again in a moment"};
  }
  ~UploadSlot() { --*count_; }
  UploadSlot(const UploadSlot&) = delete;
  UploadSlot& operator=(const UploadSlot&) = delete;

 private:
  std::atomic<int>* count_;
};

}  // namespace

class App::Impl {
 public:
  explicit Impl(AppSetup setup)
      : setup_(std::move(setup)),
        library_(setup_.library),
        errands_(setup_.program),
        queue_(setup_.program, &library_) {
    for (const Project& project : library_.Projects()) RemoveUnfinishedUploads(project.paths);
  }

  const Session& session() const { return session_; }
  const Library& library() const { return library_; }

  WebAnswer Answer(const WebRequest& request, const AllowedHosts& hosts) {
    try {
      return Route(request, hosts);
    } catch (const Refusal& refusal) {
      return ErrorAnswer(refusal);
    } catch (const UploadRefusal& refusal) {
      return ErrorAnswer({refusal.status, refusal.reason});
    } catch (const InputError& error) {
      return ErrorAnswer({400, error.what()});
    } catch (const std::exception& error) {
      return ErrorAnswer({500, error.what()});
    }
  }

 private:
  WebAnswer Route(const WebRequest& request, const AllowedHosts& hosts) {
    const bool reads = request.method == "GET" || request.method == "HEAD";
    if (!reads && request.method != "POST") {
      WebAnswer answer = PlainAnswer(405, "only GET, HEAD and POST");
      answer.headers["Allow"] = "GET, HEAD, POST";
      return answer;
    }
    if (!hosts.Allows(request)) return PlainAnswer(403, "this server does not answer to that name");
    if (reads && request.path.starts_with(Session::kPrefix)) return session_.Open(request, hosts);
    if (!session_.Holds(request, hosts)) {
      return PlainAnswer(403, "Open the address that OracleGS printed when it was started: it lets this browser in.");
    }
    if (reads) return Read(request);
    if (!Session::IsOwnPage(request)) return PlainAnswer(403, "another page asked for this");
    return Change(request);
  }

  AppParts Parts() { return {library_, queue_, &errands_, &pictures_, setup_.choices}; }

  Project Find(const std::string& id) const {
    auto project = library_.Find(id);
    if (!project) throw Refusal{404, "there is no such project any more"};
    return *project;
  }

  /// "ID/rest" as a project and "/rest".
  std::pair<Project, std::string> Split(const std::string& path) const {
    const size_t slash = std::min(path.find('/'), path.size());
    return {Find(path.substr(0, slash)), path.substr(slash)};
  }

  WebAnswer Read(const WebRequest& request) {
    const std::string& path = request.path;
    if (path == "/") return AssetAnswer("app.html", request.known_tag);
    if (path == "/api/ping") return PlainAnswer(200, "oraclegs");
    if (const auto name = PathAfter(path, "/assets/")) return AssetAnswer(*name, request.known_tag);
    if (path == "/api/library") return JsonAnswer(JsonDocument(LibraryDocument(Parts())).body, request.known_tag);
    if (const auto id = PathAfter(path, "/api/projects/")) {
      return JsonAnswer(JsonDocument(ProjectDocument(Parts(), Find(*id))).body, request.known_tag);
    }
    if (const auto rest = PathAfter(path, "/projects/")) return ReadProject(*rest, request.known_tag);
    return PlainAnswer(404, "not found");
  }

  WebAnswer ReadProject(const std::string& path, const std::string& tag) {
    const auto [project, rest] = Split(path);
    if (rest == "/view") return AssetAnswer("viewer.html", tag);
    if (rest == "/report") return ReportAnswer(project, tag);
    if (const auto id = PathAfter(rest, "/photos/")) return PhotoAnswer(project, *id, tag);
    if (const auto id = PathAfter(rest, "/exports/")) return ExportAnswer(project, *id, tag);
    const std::shared_ptr<Site> site = SiteOf(project);
    return SiteAnswer(rest, tag, site.get());
  }

  /// A report is a page with scripts of its own, from a run that may be anybody's: it is shown as if from elsewhere, so
  /// that it reaches nothing here.
  static WebAnswer ReportAnswer(const Project& project, const std::string& known_tag) {
    WebAnswer answer = FileAnswer(FileBelow::Open(project.splat(), "report.html"), "report.html", known_tag);
    if (answer.file) answer.type = "text/html; charset=utf-8";
    answer.headers["Content-Security-Policy"] =
        "sandbox allow-scripts allow-downloads allow-popups allow-popups-to-escape-sandbox; frame-ancestors 'self'";
    return answer;
  }

  static WebAnswer PhotoAnswer(const Project& project, const std::string& id, const std::string& known_tag) {
    for (const Upload& upload : UploadsOf(project.paths)) {
      if (upload.id != id || upload.kind != UploadKind::kPhoto) continue;
      const std::string name = upload.path.filename().string();
      return FileAnswer(FileBelow::Open(project.paths.photos(), name), name, known_tag);
    }
    return PlainAnswer(404, "not found");
  }

  WebAnswer ExportAnswer(const Project& project, const std::string& id, const std::string& known_tag) const {
    const ExportFormat* format = FindExportFormat(id);
    if (format == nullptr || errands_.ExportOf(project.id, *format).state == "running") {
      return PlainAnswer(404, "not found");
    }
    return Download(project.paths.exports(), ExportFile(project, *format).filename().string(),
                    project.record.name + format->extension, known_tag);
  }

  static WebAnswer Download(const fs::path& folder, const std::string& file, const std::string& name,
                            const std::string& known_tag) {
    WebAnswer answer = FileAnswer(FileBelow::Open(folder, file), file, known_tag);
    if (answer.status == 200) {
      answer.headers["Content-Disposition"] = "attachment; filename*=UTF-8''" + PercentEncoded(name);
    }
    return answer;
  }

  /// The viewer's view of a run, kept so that a document is parsed once.
  std::shared_ptr<Site> SiteOf(const Project& project) {
    const std::lock_guard guard(mutex_);
    std::shared_ptr<Site>& site = sites_[project.id];
    if (!site) site = std::make_shared<Site>(project.splat());
    return site;
  }

  WebAnswer Change(const WebRequest& request) {
    if (request.path == "/api/quit") {
      setup_.quit();
      return JsonDocument({{"ended", true}});
    }
    if (request.path == "/api/projects") return Create(ObjectOf(request));
    const auto rest = PathAfter(request.path, "/api/projects/");
    if (!rest) return PlainAnswer(404, "not found");
    const auto [project, change] = Split(*rest);
    if (change == "/upload") return Receive(project, request);
    const nlohmann::json body = ObjectOf(request);
    static constexpr std::pair<const char*, WebAnswer (Impl::*)(const Project&, const nlohmann::json&)> kChanges[] = {
        {"/forget", &Impl::Forget}, {"/start", &Impl::Start},    {"/pause", &Impl::Pause},
        {"/resume", &Impl::Resume}, {"/stop", &Impl::Stop},      {"/rename", &Impl::Rename},
        {"/delete", &Impl::Delete}, {"/edits", &Impl::SetEdits}, {"/export", &Impl::Export}};
    for (const auto& [name, make] : kChanges) {
      if (change == name) return (this->*make)(project, body);
    }
    return PlainAnswer(404, "not found");
  }

  static void RequireAtRest(const Project& project) {
    if (!IsAtRest(StateOf(project).phase)) throw Refusal{409, "the run goes on; stop it first"};
  }
  static void RequireOwn(const Project& project) {
    if (project.is_foreign) throw Refusal{409, "this run was made by a command line; change it there"};
  }

  WebAnswer Create(const nlohmann::json& body) {
    if (library_.Projects().size() >= kMaxProjects) throw Refusal{409, "the library is full; delete a project"};
    return JsonDocument({{"id", library_.Create(TextAsked(body, "name")).id}}, 201);
  }

  WebAnswer Receive(const Project& project, const WebRequest& request) {
    RequireOwn(project);
    RequireAtRest(project);
    const UploadSlot slot(&uploads_);
    const auto name = request.query.find("name");
    const Upload upload =
        ReceiveUpload(project.paths, name == request.query.end() ? "" : name->second, request, setup_.limits);
    if (upload.kind == UploadKind::kPhoto) errands_.Check(project);
    return JsonDocument({{"id", upload.id}, {"name", upload.path.filename().string()}}, 201);
  }

  WebAnswer Forget(const Project& project, const nlohmann::json& body) {
    RequireAtRest(project);
    const std::string id = TextAsked(body, "file");
    for (const Upload& upload : UploadsOf(project.paths)) {
      if (upload.id != id) continue;
      std::error_code error;
      fs::remove(upload.path, error);
      if (error) throw Refusal{500, "the file cannot be removed: " + SystemReason(error)};
      errands_.Check(project);
      return JsonDocument({{"removed", true}});
    }
    throw Refusal{404, "there is no such file any more"};
  }

  WebAnswer Start(const Project& project, const nlohmann::json& body) {
    RequireOwn(project);
    RequireAtRest(project);
    const AppChoices& choices = setup_.choices;
    const std::string quality = Chosen(body, "quality", project.record.quality, choices.qualities);
    const std::string device = Chosen(body, "device", choices.devices.front().id, choices.devices);
    DropExports(project);
    queue_.Add(project, quality, device);
    return JsonDocument({{"waits", true}});
  }

  WebAnswer Pause(const Project& project, const nlohmann::json& /*body*/) {
    if (!RunQueue::Pause(project)) throw Refusal{409, "nothing runs that could be paused"};
    return JsonDocument({{"paused", true}});
  }

  WebAnswer Resume(const Project& project, const nlohmann::json& /*body*/) {
    if (!RunQueue::Resume(project)) throw Refusal{409, "nothing is paused"};
    return JsonDocument({{"paused", false}});
  }

  WebAnswer Stop(const Project& project, const nlohmann::json& /*body*/) {
    RequireOwn(project);
    queue_.Stop(project);
    return JsonDocument({{"stops", true}});
  }

  WebAnswer Rename(const Project& project, const nlohmann::json& body) {
    RequireOwn(project);
    const std::string name = CleanName(TextAsked(body, "name"));
    library_.Update(project.id, [&](ProjectRecord* record) { record->name = name; });
    return JsonDocument({{"name", name}});
  }

  WebAnswer Delete(const Project& project, const nlohmann::json& body) {
    RequireAtRest(project);
    const bool trashed = library_.Trash(project);
    if (!trashed && body.value("permanent", nlohmann::json()) != true) {
      throw Refusal{409, "there is no trash for this folder: it would be removed for good", true};
    }
    if (!trashed) library_.Remove(project);
    errands_.Forget(project.id);
    const std::lock_guard guard(mutex_);
    sites_.erase(project.id);
    return JsonDocument({{"trash", trashed}});
  }

  WebAnswer SetEdits(const Project& project, const nlohmann::json& body) {
    RequireOwn(project);
    const ExportEdits edits = EditsFromJson(body, project.record.edits);
    library_.Update(project.id, [&](ProjectRecord* record) { record->edits = edits; });
    DropExports(project);
    return JsonDocument(EditsToJson(edits));
  }

  WebAnswer Export(const Project& project, const nlohmann::json& body) {
    RequireOwn(project);
    RequireAtRest(project);
    const ExportFormat* format = FindExportFormat(TextAsked(body, "format"));
    if (format == nullptr) throw Refusal{400, "there is no such format"};
    std::error_code ignored;
    if (!fs::exists(project.splat() / "point_cloud.ply", ignored)) throw Refusal{409, "there is no splat yet"};
    errands_.Export(project, *format);
    return JsonDocument({{"id", format->id}});
  }

  /// Exports of another splat or of other edits.
  void DropExports(const Project& project) {
    std::error_code ignored;
    fs::remove_all(project.paths.exports(), ignored);
    for (const ExportFormat& format : ExportFormats()) errands_.ForgetExport(project.id, format);
  }

  AppSetup setup_;
  Library library_;
  Errands errands_;
  RunQueue queue_;
  Pictures pictures_;
  Session session_;
  std::atomic<int> uploads_ = 0;
  std::mutex mutex_;
  std::map<std::string, std::shared_ptr<Site>> sites_;
};

App::App(AppSetup setup) : impl_(std::make_unique<Impl>(std::move(setup))) {}
App::~App() = default;

std::string App::OpenPath() const { return impl_->session().path(); }
const fs::path& App::library() const { return impl_->library().root(); }

WebHandler App::Handler() {
  return [this](const WebRequest& request, const AllowedHosts& hosts) {
    return Restricted(impl_->Answer(request, hosts), Frames::kThisServer);
  };
}

}  // namespace oraclegs
