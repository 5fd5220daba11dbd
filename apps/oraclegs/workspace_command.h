#pragma once
// The commands that read a scene and fill a workspace: reconstruct, sfm, train.

#include <string>

#include "command.h"
#include "oraclegs/pipeline/run.h"

namespace oraclegs {

class WorkspaceCommand : public Command {
 protected:
  WorkspaceCommand(CLI::App* app, const std::string& name, const std::string& help, const std::string& example)
      : Command(app, name, help, example) {
    BindInput("scene", &request_.scene,
              "Scene folder: photos, a COLMAP model, transforms.json or a Blender scene; never written to");
    Bind("Output", &workspace_);
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
    Fill(request_, listener);
  }

  RunRequest request_;
  WorkspaceOptions workspace_;
};

}  // namespace oraclegs
