#pragma once
// A folder of weights as `oraclegs models` leaves it, of networks so small that a whole run takes seconds: all that the
// paper's pipeline asks for.

#include "networks/seva/tiny_files.h"
#include "networks/vggt/fixture.h"
#include "networks/network_files.h"

namespace oraclegs {

inline void WriteTinyNetworks(const std::filesystem::path& models) {
  WriteTinySeva(models);
  WriteTinyVggt(models / "vggt" / "model.safetensors");
  WriteTinyDepthAnything(models / "depth-anything-v2-small" / "model.safetensors");
  WriteTinyLpips(models / "lpips-vgg" / "model.safetensors");
}

}  // namespace oraclegs
