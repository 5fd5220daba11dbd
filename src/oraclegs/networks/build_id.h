#pragma once
// The identity of a build: program and library of networks must agree on every byte that crosses between them.

#include <cstdint>
#include <string>

#include "oraclegs/networks/networks.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {

/// Hash of the sizes of the types that cross the border, and of the compiler.
consteval uint64_t SharedLayout() {
  uint64_t hash = 0xcbf29ce484222325;
  const auto add = [&hash](uint64_t value) { hash = (hash ^ value) * 0x100000001b3; };
  for (const uint64_t size :
       {sizeof(Buffer<float>), sizeof(Storage), sizeof(Image8), sizeof(ImageF), sizeof(Camera), sizeof(LoadedView),
        sizeof(SevaOptions), sizeof(ViewRequest), sizeof(ViewGeneratorRequest), sizeof(PoseRequest),
        sizeof(PoseEstimate), sizeof(CloudPoint), sizeof(ImageFeatures), sizeof(KeypointOptions), sizeof(Device),
        sizeof(Event)}) {
    add(size);
  }
  for (const char* c = __VERSION__; *c != '\0'; ++c) add(static_cast<uint64_t>(*c));
  return hash;
}

/// "0.1.0-3f2a9c01b7e4-8d1f...": the version, the interface's source, the layout. Each side has its own copy of this
/// function: a shared one would compare a build with itself.
[[maybe_unused]] static std::string NetworksBuildId() {
  return fmt::format("{}-{:016x}", ORACLEGS_NETWORKS_SOURCE, SharedLayout());
}

/// Functions that the library exports.
inline constexpr const char* kBuildFunction = "oraclegs_networks_build";    ///< const char* ()
inline constexpr const char* kCreateFunction = "oraclegs_networks_create";  ///< const Networks* ()

}  // namespace oraclegs
