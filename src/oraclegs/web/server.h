#pragma once
// The server of the pages (docs/viewer.md#security-of-the-viewer).

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "oraclegs/web/routes.h"

namespace oraclegs {

inline constexpr int kDefaultWebPort = 7860;

/// Makes the answer to a request, on any thread. `hosts` are the names of the server.
using WebHandler = std::function<WebAnswer(const WebRequest& request, const AllowedHosts& hosts)>;

/// Shows the run in a folder: a workspace, or any folder with report/run.json (web/site.h).
WebHandler ViewerOf(const std::filesystem::path& root);

struct WebServerOptions {
  std::string host = "127.0.0.1";  ///< address or name to bind to
  std::optional<int> port = {};    ///< exactly this port; unset = 7860 or the next free one
};

/// Answers requests from its own threads from construction to destruction, at most 48 at a time; a client that is slow,
/// sends too much or asks for missing files does not disturb others.
class WebServer {
 public:
  /// Starts to serve. Throws UsageError when the port is in use or the host is not of this machine, RunError when the
  /// viewer's pages are not part of this build.
  WebServer(const WebServerOptions& options, WebHandler handler);
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  int port() const;
  /// Address such as "http://127.0.0.1:7860/"; for a wildcard, one for a browser on this machine.
  std::string url() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace oraclegs
