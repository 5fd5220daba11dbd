#pragma once

#include <filesystem>
#include <memory>

#include "oraclegs/core/progress.h"
#include "oraclegs/web/server.h"
#include "oraclegs/web/viewer_options.h"

namespace oraclegs {

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
