#include "oraclegs/propose/stored_proposer.h"

#include "oraclegs/core/error.h"
#include "oraclegs/image/read_image.h"

namespace oraclegs {

std::optional<Proposal> StoredProposer::Propose(const Target& target, std::optional<int> held_out) const {
  if (held_out) return std::nullopt;
  const std::filesystem::path path = folder_ / (target.name + ".png");
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return std::nullopt;
  Proposal proposal{target.name, source_, target.camera, ToFloat(ReadImage(path))};
  const ImageF& rgb = proposal.rgb;
  if (rgb.width != target.camera.width || rgb.height != target.camera.height || rgb.channels != 3) {
    throw InputError("{}: is {} x {} with {} channels, not {} x {} with 3; delete it and run again", path.string(),
                     rgb.width, rgb.height, rgb.channels, target.camera.width, target.camera.height);
  }
  return proposal;
}

}  // namespace oraclegs
