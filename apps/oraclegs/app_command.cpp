#include <atomic>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <system_error>
#include <thread>

#include "command.h"
#include "oraclegs/app/app.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/folder_lock.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/text.h"
#include "oraclegs/settings/device.h"
#include "oraclegs/web/browser.h"
#include "oraclegs/web/server.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

struct AppOptions {
  fs::path library;
  int port = 0;  ///< 0 = the usual one, or the next free one
  bool browser = true;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("library", self.library, "Folder of your projects; without it OracleGS in your home folder");
    visit("port", self.port, "Port of the page, exactly this one; 0 = 7860, or the next one that is free",
          Range{0, 65535});
    visit("browser", self.browser, "Open the page in a browser where there is one");
  }
};

fs::path UsualLibrary() {
  const char* home = std::getenv("HOME");
  if (home == nullptr || *home == '\0') {
    throw UsageError("--library: name a folder for your projects; there is no home folder");
  }
  return fs::path(home) / "OracleGS";
}

AppChoices ChoicesHere() {
  AppChoices choices{{{"draft", "Draft: a first look within minutes"},
                      {"normal", "Normal"},
                      {"high", "High: the most detail, for much longer"}},
                     {{"auto", "The fastest there is"}},
                     "normal"};
  if (ProbeDevices().devices > 0) {
    choices.devices.push_back({"cuda", "Graphics card"});
    choices.devices.push_back({"cpu", "Processor"});
  }
  return choices;
}

/// Name of the page in the library that leads in.
constexpr const char* kEntryName = "Open OracleGS.html";

std::string FileAddress(const fs::path& file) { return "file://" + PercentEncoded(file.string()); }

/// A page in the library that leads in, for its owner alone, since the addresses that browsers are started with can be
/// seen by all users of the machine. Removed at the end of the scope.
class EntryPage {
 public:
  EntryPage(const fs::path& library, const std::string& address) : file_(library / kEntryName) {
    std::error_code error;
    fs::remove(file_, error);
    WriteFileAtomically(file_, "");
    fs::permissions(file_, fs::perms::owner_read | fs::perms::owner_write, error);
    if (error) throw RunError("{}: cannot be kept from other users: {}", file_.string(), SystemReason(error));
    ReplaceKept(address);
  }
  ~EntryPage() {
    std::error_code ignored;
    fs::remove(file_, ignored);
  }
  EntryPage(const EntryPage&) = delete;
  EntryPage& operator=(const EntryPage&) = delete;

  std::string Url() const { return FileAddress(file_); }

 private:
  void ReplaceKept(const std::string& address) const {
    std::ofstream out(file_, std::ios::binary | std::ios::trunc);  // in place: the permissions stay
    out << "<!doctype html><title>OracleGS</title><meta http-equiv=\"refresh\" content=\"0; url=" << address
        << "\"><a href=\"" << address << "\">OracleGS</a>\n";
    if (!out.flush()) throw RunError("{}: cannot be written", file_.string());
  }
  fs::path file_;
};

class AppCommand : public Command {
 public:
  explicit AppCommand(CLI::App* app)
      : Command(app, "app", "A page in the browser: drop photos, get a splat; no further commands", "oraclegs app") {
    Bind("Page", &options_);
  }

 private:
  /// Opens the page of an app that shows the library already; false where none does.
  bool OpenRunning(const fs::path& library) const {
    std::error_code ignored;
    const fs::path entry = fs::absolute(library, ignored) / kEntryName;
    if (!IsFolderLocked(library) || !fs::exists(entry, ignored)) return false;
    const bool opened = options_.browser && OpenBrowser(FileAddress(entry));
    WriteOut(fmt::format("app        is running already: {}{}\n", FileAddress(entry),
                         opened ? "" : " (open it in a browser)"));
    return true;
  }

  void Body(const Listener& /*listener*/) override {
    const fs::path library = options_.library.empty() ? UsualLibrary() : options_.library;
    if (OpenRunning(library)) return;
    std::atomic<bool> ended = false;
    App app({library, fs::canonical("/proc/self/exe"), ChoicesHere(), {}, [&ended] { ended = true; }});
    WebServerOptions server_options;
    if (options_.port != 0) server_options.port = options_.port;
    const WebServer server(server_options, app.Handler());
    const std::string address = server.url() + app.OpenPath().substr(1);
    const EntryPage entry(app.library(), address);
    const bool opened = options_.browser && OpenBrowser(entry.Url());
    // Also with --quiet: without the address nobody finds it.
    WriteOut(fmt::format("app        {}{}\n", address, opened ? "" : " (open it in a browser)"));
    Print(fmt::format("library    {}; Ctrl-C ends the page, runs go on", app.library().string()));
    while (!InterruptRequested() && !ended) std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }

  AppOptions options_;
};

}  // namespace

std::unique_ptr<Command> MakeApp(CLI::App* app) { return std::make_unique<AppCommand>(app); }

}  // namespace oraclegs
