#pragma once
// --masks: a user's program that masks the photos (docs/formats.md#masks-by-a-command).

#include <filesystem>
#include <string>

#include "oraclegs/core/progress.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

struct MaskRun {
  std::string command;         ///< for sh; {request} and {answer} are replaced by the two folders
  int timeout = 0;             ///< seconds, 0 = none
  std::filesystem::path root;  ///< folder of the workspace that receives the masks
};

/// Writes the photos of all views as the run reads them, at full size and upright, runs the command (RunUserCommand) in
/// root/command, and stores its answers as root/NAME.png, less what the mask of a view excludes. Reports them as
/// StepDone{"masks"}. Throws InputError for photos that it did not answer for, which names how many and the first, and
/// as CheckMasks; RunError as RunUserCommand.
void MakeMasks(const MaskRun& run, const Scene& scene, const Listener& listener);

/// Gives each view its mask of MakeMasks and checks them (CheckMasks). Throws InputError for one that is missing.
void TakeMasks(const std::filesystem::path& root, const Listener& listener, Scene* scene);

}  // namespace oraclegs
