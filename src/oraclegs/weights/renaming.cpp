#include "oraclegs/weights/renaming.h"

#include <string_view>
#include <utility>

namespace oraclegs {
namespace {

constexpr std::string_view kAutoencoder = "sd21-vae", kAttention = ".attentions.", kDigits = "0123456789";
constexpr std::string_view kTapEnding = ".1.weight";
constexpr std::pair<std::string_view, std::string_view> kOldNames[] = {
    {"query.", "to_q."}, {"key.", "to_k."}, {"value.", "to_v."}, {"proj_attn.", "to_out.0."}};

/// Where the name of a layer begins in "decoder.mid_block.attentions.0.query.weight": behind the block's number.
size_t LayerOfAttention(std::string_view name) {
  const size_t attention = name.find(kAttention);
  if (attention == std::string_view::npos) return attention;
  const size_t number = attention + kAttention.size(), end = name.find_first_not_of(kDigits, number);
  const bool numbered = end != number && end != std::string_view::npos && name[end] == '.';
  return numbered ? end + 1 : std::string_view::npos;
}

}  // namespace

std::string NameInNetwork(const std::string& parameters, const std::string& published) {
  const std::string_view name = published;
  // Version 0.1 of LPIPS names the weights of its taps "0.1.weight" in some copies.
  const bool is_tap = name.size() == 1 + kTapEnding.size() && name.ends_with(kTapEnding);
  if (parameters.starts_with("lpips-") && is_tap && name[0] >= '0' && name[0] <= '4') {
    return std::string("lin") + name[0] + ".model" + std::string(kTapEnding);
  }
  const size_t layer = parameters == kAutoencoder ? LayerOfAttention(name) : std::string_view::npos;
  if (layer == std::string_view::npos) return published;
  for (const auto& [old_name, new_name] : kOldNames) {
    if (!name.substr(layer).starts_with(old_name)) continue;
    return std::string(name.substr(0, layer)) + std::string(new_name) +
           std::string(name.substr(layer + old_name.size()));
  }
  return published;
}

StoredTensor ShapedForNetwork(const std::string& parameters, const std::string& name, StoredTensor tensor) {
  const size_t layer = parameters == kAutoencoder ? LayerOfAttention(name) : std::string::npos;
  const bool is_convolution = tensor.shape.size() == 4 && tensor.shape[2] == 1 && tensor.shape[3] == 1;
  if (layer == std::string::npos || !is_convolution || !name.ends_with(".weight")) return tensor;
  for (const auto& [old_name, new_name] : kOldNames) {
    if (std::string_view(name).substr(layer) != std::string(new_name) + "weight") continue;
    tensor.shape.resize(2);
    tensor.strides.resize(2);
  }
  return tensor;
}

}  // namespace oraclegs
