#include "source_command.h"

#include <nlohmann/json.hpp>

#include "config_file.h"
#include "oraclegs/settings/named_options.h"
#include "oraclegs/settings/run_size.h"
#include "oraclegs/workspace/stage_records.h"

namespace oraclegs {

SourceCommand::SourceCommand(CLI::App* app, const std::string& name, const std::string& help,
                             const std::string& example)
    : Command(app, name, help, example) {
  BindInput("input", &input_, "Workspace of a run, or a scene folder together with --ply");
  Bind("Model", &model_);
  Bind("Output", &out_);
  BindRun(&options_);
}

namespace {

/// Opens a run and reports only warnings and long work, since the run's own commands reported the rest.
oraclegs::Run OpenQuietly(const RunRequest& request, const Listener& listener) {
  oraclegs::Run run = OpenRun(request, [&](const Event& event) {
    if (std::holds_alternative<Warning>(event) || std::holds_alternative<StepDone>(event)) listener(event);
  });
  run.listener = listener;
  return run;
}

/// Options of a saved run. Throws InputError naming the file for an impossible value.
RunOptions ReadSavedOptions(const std::filesystem::path& workspace) {
  const std::filesystem::path file = WorkspacePaths(workspace).options();
  RunOptions options;
  OptionTable table = TableOf(&options);
  ApplySavedOptions(ReadSavedRun(workspace).options, file, &table);
  try {
    CheckRunOptions(options);
  } catch (const UsageError& error) {
    throw InputError("{}: {}; the file was changed: bring it back, or start anew", file.string(), error.what());
  }
  return options;
}

}  // namespace

oraclegs::Run OpenRunAsSaved(const std::filesystem::path& workspace, const MachineOptions& machine,
                             const DeviceOptions& device, const Listener& listener) {
  if (!IsWorkspace(workspace)) {
    throw InputError("{}: holds no run of oraclegs; name a workspace", workspace.string());
  }
  RunRequest request;
  request.out = workspace;
  request.version = ORACLEGS_VERSION;
  request.options = ReadSavedOptions(workspace);
  request.options.machine = machine, request.options.device = device;
  return OpenQuietly(request, listener);
}

oraclegs::Run SourceCommand::OpenSavedRun(const std::filesystem::path& workspace, const Listener& listener) const {
  return OpenRunAsSaved(workspace, options_.machine, options_.device, listener);
}

bool SourceCommand::InputIsWorkspace() const { return IsWorkspace(input_); }

std::filesystem::path SourceCommand::SplatFile(const Listener& listener) const {
  if (!model_.ply.empty()) return model_.ply;
  WarnOfUnfinished(input_, listener);
  return WorkspacePaths(input_).point_cloud();
}

void SourceCommand::ApplyDefaults() {
  if (InputIsWorkspace()) {
    ReadSavedOptions(input_);  // the command line and --config are checked later, and named otherwise
    nlohmann::json saved = ReadSavedRun(input_).options;
    for (const char* name : {"threads", "device"}) saved.erase(name);  // belong to the machine, not to the run
    ApplySavedOptions(saved, WorkspacePaths(input_).options(), &table());
  } else if (model_.ply.empty()) {
    throw UsageError("{}: holds no run of oraclegs; name a workspace, or a point cloud with --ply", input_.string());
  }
}

std::optional<oraclegs::Run> SourceCommand::OpenRunOfInput(const Listener& listener) const {
  if (!InputIsWorkspace()) return std::nullopt;
  RunRequest request;
  request.out = input_;
  request.options = options_;
  request.version = ORACLEGS_VERSION;
  return OpenQuietly(request, listener);
}

PosedScene SourceCommand::OpenScene(const Listener& listener) {
  if (!InputIsWorkspace()) {
    PosedScene posed = ReadPosedScene(input_, options_, listener);
    options_ = WithBackground(options_, posed.scene);
    return posed;
  }
  const Auto<int> asked = options_.image.max_size, own = ReadSavedOptions(input_).image.max_size;
  options_.image.max_size = own;
  auto run = OpenRunOfInput(listener);
  options_.image = run->options.image;
  if (asked != own) options_.image.max_size = asked;
  return {std::move(run->scene), std::move(run->split), run->frame};
}

}  // namespace oraclegs
