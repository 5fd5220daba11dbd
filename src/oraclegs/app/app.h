#pragma once
// The app: photos dropped into a page become splats (docs/app.md).

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "oraclegs/app/documents.h"
#include "oraclegs/app/uploads.h"
#include "oraclegs/web/server.h"

namespace oraclegs {

struct AppSetup {
  std::filesystem::path library;  ///< folder of the projects; made where it is missing
  std::filesystem::path program;  ///< this program, which the app runs
  AppChoices choices;
  UploadLimits limits;
  std::function<void()> quit;  ///< called when somebody ends the app by its page; from any thread
};

/// The state behind the page's requests: library, queue, errands and the secret of this start. Runs go on without it.
class App {
 public:
  /// Throws RunError when the library cannot be written, or is shown by another app.
  explicit App(AppSetup setup);
  ~App();
  App(const App&) = delete;
  App& operator=(const App&) = delete;

  /// Path that lets a browser in.
  std::string OpenPath() const;
  const std::filesystem::path& library() const;

  /// Answers requests, on any thread; this object must live longer.
  WebHandler Handler();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace oraclegs
