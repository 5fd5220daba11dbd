#pragma once
// Files of small networks with made-up weights: what a run finds on a machine that has fetched the real ones. They are
// made when the tests are built (tests/e2e/tiny_networks.cpp).

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include "oraclegs/core/safetensors.h"
#include "support/golden.h"

namespace oraclegs {

/// Whether this build has networks, that is libtorch.
bool HasNetworks();
#define SKIP_WITHOUT_NETWORKS() \
  if (!oraclegs::HasNetworks()) GTEST_SKIP() << "this build has no networks"

/// Depth Anything V2 with one of two sets of weights, seed 5 or 6.
std::filesystem::path WriteTinyDepthAnything(const std::filesystem::path& path, uint64_t seed = 5);
/// LPIPS with VGG16, seed 7 or 8.
std::filesystem::path WriteTinyLpips(const std::filesystem::path& path, uint64_t seed = 7);
std::filesystem::path WriteTinyAlexNetLpips(const std::filesystem::path& path);
std::filesystem::path WriteTinyAliked(const std::filesystem::path& path);

/// Files of Stable Virtual Camera below a folder of models: seva, sd21-vae and openclip-vith14.
void WriteTinySeva(const std::filesystem::path& models);
/// Files of all networks of the paper's pipeline, as `oraclegs models` stores them.
void WriteTinyNetworks(const std::filesystem::path& models);

/// A file of 1.2 GB that takes no room and holds zeros: as large as a network that takes hours on a CPU. Returns
/// `path`.
std::filesystem::path WriteLargeWeights(const std::filesystem::path& path);

/// VGGT: the weights of tests/golden/vggt_tiny as a file of their own, under the official names and with its metadata;
/// `change` may alter both. Needs no libtorch.
struct TinyVggtParts {
  std::map<std::string, TensorEntry> tensors;
  std::map<std::string, std::string> metadata;
};
std::filesystem::path WriteTinyVggt(
    const std::filesystem::path& path, const std::function<void(TinyVggtParts*)>& change = [](TinyVggtParts*) {});

}  // namespace oraclegs
