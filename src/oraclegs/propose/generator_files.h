#pragma once
// What a generator of the user's is given and what it answers, as files (docs/generators.md).

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "oraclegs/camera/similarity.h"
#include "oraclegs/propose/proposal.h"
#include "oraclegs/propose/warp.h"

namespace oraclegs {

/// Below proposals/generator.
struct GeneratorPaths {
  std::filesystem::path root;

  std::filesystem::path request() const { return root / "request"; }
  std::filesystem::path answer() const { return root / "answer"; }
  std::filesystem::path log() const { return root / "log.txt"; }
};

/// height * width: 255 where the warp shows what images show, 0 in its holes: the depth there was made up, or no image
/// shows the point.
std::vector<uint8_t> KnownPixels(const WarpedView& view);

/// Empties the folder and writes, below request/: transforms.json with the targets' poses (WriteTargets),
/// warps/NAME.png (8-bit RGB) and masks/NAME.png (8-bit gray, KnownPixels) of each, and images/ with the views at
/// working size and their own transforms.json, all poses moved by `placement`. Leaves answer/ empty. Throws RunError.
void WriteGeneratorRequest(const GeneratorPaths& paths, const std::vector<Target>& targets,
                           const std::vector<LoadedView>& views, const Warper& warper,
                           const Similarity& placement = {});

/// Targets for which answer/ has an image.
size_t CountAnswers(const GeneratorPaths& paths, const std::vector<Target>& targets);

/// The image of each target: answer/NAME.png, .jpg or .jpeg. Throws InputError naming the file: missing, unreadable, of
/// another size than the target's, transparent anywhere.
std::vector<Image8> ReadAnswers(const GeneratorPaths& paths, const std::vector<Target>& targets);

}  // namespace oraclegs
