#pragma once
// The commands that read a scene and fill a workspace: reconstruct, sfm, train.

#include <unistd.h>

#include <filesystem>
#include <optional>
#include <string>

#include "command.h"
#include "oraclegs/core/text.h"
#include "oraclegs/run/start.h"
#include "viewing.h"

namespace oraclegs {

struct LiveViewOptions {
  bool view = false;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("view", self.view,
          "Serve the viewer while the run goes on; afterwards, where the output is a terminal, until Ctrl-C");
  }
};

/// Extras that a command offers beside filling the workspace.
struct WorkspaceOffers {
  bool view = false;  ///< --view: to show the run
};

class WorkspaceCommand : public Command {
 protected:
  WorkspaceCommand(CLI::App* app, const std::string& name, const std::string& help, const std::string& example,
                   WorkspaceOffers offers = {})
      : Command(app, name, help, example) {
    BindInputs(
        "input", &request_.inputs,
        "What to reconstruct, never written to: a folder of photos or a posed scene (COLMAP model, transforms.json, "
        "Blender, LLFF, Metashape, ...), or any number of photos, videos, zip archives and folders of photos");
    Bind("Input", &request_.options.capture);
    Bind("Output", &workspace_);
    if (offers.view) {
      Bind("Viewer", &live_);
      Bind("Viewer", &viewer_, Level::kAdvanced);
    }
    BindRun(&request_.options);
  }

  /// The command's own part; the request is complete.
  virtual void Fill(const RunRequest& request, const Listener& listener) = 0;

 private:
  void Body(const Listener& listener) final {
    RequireOut(workspace_.out);
    request_.out = workspace_.out;
    request_.overwrite = workspace_.overwrite;
    request_.version = ORACLEGS_VERSION;
    std::optional<Viewing> viewing;
    if (live_.view) request_.on_claimed = [&] { StartViewing(listener, &viewing); };
    Fill(request_, listener);
    // A script that waits for the run must not wait for ever.
    if (viewing && isatty(STDOUT_FILENO)) {
      Print("the run is finished; the viewer goes on until Ctrl-C");
      viewing->Wait();
    }
  }

  /// Serves the viewer; a failure is a warning, since the run matters more.
  void StartViewing(const Listener& listener, std::optional<Viewing>* viewing) const {
    try {
      viewing->emplace(workspace_.out, viewer_, listener);
    } catch (const std::exception& error) {
      listener(
          Warning{fmt::format("{}; the run goes on without the viewer, `oraclegs view {}` shows it from another "
                              "terminal",
                              error.what(), ShellQuoted(workspace_.out.string()))});
    }
  }

  RunRequest request_;
  WorkspaceOptions workspace_;
  LiveViewOptions live_;
  ViewerOptions viewer_;
};

}  // namespace oraclegs
