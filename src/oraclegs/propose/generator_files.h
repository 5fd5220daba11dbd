#pragma once
// Files of a user's generator: the request and the answers (docs/generators.md).

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "oraclegs/camera/similarity.h"
#include "oraclegs/core/user_command.h"
#include "oraclegs/propose/proposal.h"
#include "oraclegs/propose/warp.h"

namespace oraclegs {

/// Mask of a warp, height * width: 255 where the warp shows what images show, 0 in its holes, where the depth was made
/// up or no image shows the point.
std::vector<uint8_t> KnownPixels(const WarpedView& view);

/// Empties the folder and writes, below request/: transforms.json with the targets' poses (WriteTargets),
/// warps/NAME.png (8-bit RGB) and masks/NAME.png (8-bit gray, KnownPixels) of each target, and images/ with the views
/// at working size and their own transforms.json, all poses moved by `placement`. Creates an empty answer/. Throws
/// RunError.
void WriteGeneratorRequest(const CommandFolders& paths, const std::vector<Target>& targets,
                           const std::vector<LoadedView>& views, const Warper& warper,
                           const Similarity& placement = {});

/// Number of targets for which answer/ has an image.
size_t CountAnswers(const CommandFolders& paths, const std::vector<Target>& targets);

/// The image of each target: answer/NAME.png, .jpg or .jpeg. Throws InputError naming the file: missing, unreadable, of
/// another size than the target's, transparent anywhere.
std::vector<Image8> ReadAnswers(const CommandFolders& paths, const std::vector<Target>& targets);

}  // namespace oraclegs
