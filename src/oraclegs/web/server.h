#pragma once
// The server of the viewer (docs/viewer.md#security-of-the-viewer).

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace oraclegs {

inline constexpr int kDefaultWebPort = 7860;

struct WebServerOptions {
  std::filesystem::path root;      ///< a workspace, or any folder with report/run.json (web/site.h)
  std::string host = "127.0.0.1";  ///< address or name to bind to
  std::optional<int> port = {};    ///< exactly this port; unset = 7860 or the next free one
};

/// Serves a folder from its own threads from construction to destruction. Only reads. Requests are answered
/// concurrently, at most 48 at a time; a client that is slow, sends too much or asks for missing files does not disturb
/// others.
class WebServer {
 public:
  /// Starts to serve. Throws UsageError when the port is in use or the host is not of this machine, RunError when the
  /// viewer's pages are not part of this build.
  explicit WebServer(const WebServerOptions& options);
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
