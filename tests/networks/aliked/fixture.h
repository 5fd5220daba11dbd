#pragma once
// ALIKED of narrow blocks with its reference numbers, which its public implementation computed.

#include "networks/fixtures.h"
#include "oraclegs/networks/aliked/aliked.h"

namespace oraclegs::aliked {

inline constexpr const char* kGolden = "aliked_tiny";

inline Aliked GoldenAliked() {
  FileParameters weights = GoldenWeights(kGolden);
  const Aliked network = LoadAliked(weights, {{4, 8, 12, 16}, 4});
  weights.Finish();
  return network;
}

inline FeatureMaps GoldenMaps(const Aliked& network, const SafetensorsFile& file) {
  return Forward(network.encoder, GoldenFloat(file, "image"));
}

}  // namespace oraclegs::aliked
