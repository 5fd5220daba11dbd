#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "oraclegs/core/options.h"
#include "oraclegs/core/progress.h"
#include "oraclegs/web/server.h"

namespace oraclegs {

/// Address of the viewer.
struct ViewerOptions {
  int port = 0;  ///< 0 = the usual one, or the next free one
  std::string host = "127.0.0.1";
  bool browser = true;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("port", self.port, "Port of the viewer, exactly this one; 0 = 7860, or the next one that is free",
          Range{0, 65535});
    visit("host", self.host,
          "Address the viewer is served at; any other than this machine's own, such as 0.0.0.0, lets everyone who "
          "reaches it look on");
    visit("browser", self.browser, "Open the viewer in a browser where there is one");
  }
};

/// A server that shows a folder, announced on stdout and opened in a browser, until the end of the scope.
class Viewing {
 public:
  /// Throws what WebServer does.
  Viewing(const std::filesystem::path& root, const ViewerOptions& options, const Listener& listener);

  /// Returns when the user asks for the end (Ctrl-C).
  void Wait() const;

 private:
  WebServer server_;
};

}  // namespace oraclegs
