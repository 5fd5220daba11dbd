#include "oraclegs/networks/networks.h"

#include <utility>

#include "oraclegs/core/safetensors.h"

namespace oraclegs {

std::string DepthNetworkName(const std::filesystem::path& weights) {
  constexpr const char* kPositions = "pretrained.pos_embed";
  const SafetensorsFile file = SafetensorsFile::Open(weights);
  if (!file.Has(kPositions) || file.Get(kPositions).shape.size() != 3) {
    throw InputError("{}: is no Depth Anything V2, it has no {} with 3 dimensions; name its official weights",
                     weights.string(), kPositions);
  }
  const int64_t width = file.Get(kPositions).shape[2];
  for (const auto& [published, word] : {std::pair{384, "small"}, std::pair{768, "base"}, std::pair{1024, "large"}}) {
    if (width == published) return std::string("Depth Anything V2 ") + word;
  }
  return "Depth Anything V2 of another size";
}

}  // namespace oraclegs
