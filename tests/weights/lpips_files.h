#pragma once
// The two files that lpips-alex is published as, with zeros in place of its numbers.

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "checkpoint/torch_bytes.h"
#include "oraclegs/weights/checkpoint/stored_tensor.h"
#include "oraclegs/weights/parameter_list.h"

namespace oraclegs {

using Shapes = std::map<std::string, std::vector<int64_t>>;

/// A checkpoint of tensors of this shape.
inline std::string ZerosFile(const Shapes& shapes) {
  std::vector<std::pair<std::string, std::string>> tensors;
  std::map<std::string, std::string> storages;
  for (const auto& [name, shape] : shapes) {
    int64_t numel = 1;
    for (const int64_t size : shape) numel *= size;
    const std::string key = std::to_string(storages.size());
    storages[key] = std::string(static_cast<size_t>(2 * numel), '\0');
    tensors.emplace_back(
        name, torch_bytes::Tensor(torch_bytes::Storage(key, numel, "HalfStorage"), {shape, ContiguousStrides(shape)}));
  }
  return torch_bytes::ZipFile(torch_bytes::Dict(tensors), storages);
}

/// Tensors of the convolutions, a part of the classifier, which is not used, and `more`.
inline std::string LpipsFeatures(const Shapes& more = {}) {
  Shapes shapes = more;
  for (const auto& [name, tensor] : ParametersOf("lpips-alex").tensors) {
    if (name.starts_with("features.")) shapes[name] = tensor.shape;
  }
  shapes["classifier.6.bias"] = {10};
  return ZerosFile(shapes);
}

/// Weights of the taps under the names of some copies; the first one has that many channels.
inline std::string LpipsTaps(int64_t channels = 64) {
  return ZerosFile({{"0.1.weight", {1, channels, 1, 1}},
                    {"1.1.weight", {1, 192, 1, 1}},
                    {"2.1.weight", {1, 384, 1, 1}},
                    {"3.1.weight", {1, 256, 1, 1}},
                    {"4.1.weight", {1, 256, 1, 1}}});
}

}  // namespace oraclegs
