#pragma once
// Commands that look at a finished model: of a workspace, or a PLY with a scene.

#include <optional>

#include "command.h"
#include "oraclegs/run/start.h"

namespace oraclegs {

struct ModelOptions {
  std::filesystem::path ply;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("ply", self.ply,
          "Point cloud to use, of any 3DGS trainer; needed with a scene, in place of the run's own otherwise");
  }
};

struct OutOptions {
  std::filesystem::path out;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("out", self.out, "Folder that receives the results");
  }
};

/// Opens a run with the options that it was saved with, but for the machine's. Throws InputError when the folder is no
/// workspace.
oraclegs::Run OpenRunAsSaved(const std::filesystem::path& workspace, const MachineOptions& machine,
                             const DeviceOptions& device, const Listener& listener);

/// Has a positional that is a workspace (whose options are then in force) or a scene folder, and --ply.
class SourceCommand : public Command {
 protected:
  SourceCommand(CLI::App* app, const std::string& name, const std::string& help, const std::string& example);

  void ApplyDefaults() override;
  /// The run of the workspace; nullopt when the positional is a scene.
  std::optional<oraclegs::Run> OpenRunOfInput(const Listener& listener) const;
  /// Opens the scene: the run's, whose size of images is in options_ then unless --max-size is given, or the folder's
  /// own.
  PosedScene OpenScene(const Listener& listener);

  bool InputIsWorkspace() const;
  /// --ply, or the splat of the workspace; warns of one that is not the result of its run.
  std::filesystem::path SplatFile(const Listener& listener) const;
  /// Another run, with the options that it was saved with. Throws InputError when the folder is no workspace.
  oraclegs::Run OpenSavedRun(const std::filesystem::path& workspace, const Listener& listener) const;

  std::filesystem::path input_;
  RunOptions options_;
  ModelOptions model_;
  OutOptions out_;
};

}  // namespace oraclegs
