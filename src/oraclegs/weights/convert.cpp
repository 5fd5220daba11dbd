#include "oraclegs/weights/convert.h"

#include <map>
#include <memory>
#include <string_view>
#include <utility>

#include "oraclegs/core/atomic_file.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/safetensors_layout.h"
#include "oraclegs/core/text.h"
#include "oraclegs/weights/check.h"
#include "oraclegs/weights/checkpoint/published_checkpoint.h"
#include "oraclegs/weights/parameter_list.h"

namespace oraclegs {
namespace fs = std::filesystem;
namespace {

constexpr uint64_t kMaxGrowth = 16;  // of bytes: tensors may share their numbers, but not all of them the same ones

struct Sources {
  StateDict tensors;
  uint64_t bytes = 0;  // of the files
  std::vector<std::shared_ptr<const void>> mapped;
  std::string names;  // of the files: "a.pth + b.pth"
};

Sources ReadSources(const ConvertRequest& request) {
  const std::string parameters = request.model ? request.model->parameters : "";
  const ParameterList expected = request.model ? ParametersOf(parameters) : ParameterList{};
  Sources sources;
  for (const fs::path& file : request.files) {
    PublishedCheckpoint checkpoint = ReadPublishedCheckpoint(file, request.key);
    for (auto& [published, tensor] : checkpoint.tensors) {
      const std::string name = request.model ? NameInNetwork(parameters, published) : published;
      if (expected.Ignores(name)) continue;
      if (!sources.tensors.emplace(name, ShapedForNetwork(parameters, name, std::move(tensor))).second) {
        throw InputError("{}: holds tensor '{}' a second time; convert the files one by one", file.string(),
                         Printable(name));
      }
    }
    sources.bytes += checkpoint.bytes;
    sources.mapped.insert(sources.mapped.end(), checkpoint.mapped.begin(), checkpoint.mapped.end());
    sources.names += (sources.names.empty() ? "" : " + ") + file.filename().string();
  }
  return sources;
}

std::string Where(const ConvertRequest& request) {
  std::vector<std::string> names;
  for (const fs::path& file : request.files) names.push_back(file.string());
  return fmt::format("{}", fmt::join(names, " and "));
}

/// Keeps what the network has, and complains of what it lacks.
void FitToNetwork(const ConvertRequest& request, StateDict* tensors, const Listener& listener) {
  const WeightsInfo& model = *request.model;
  const ParameterList expected = ParametersOf(model.parameters);
  std::map<std::string, TensorLayout> held;
  for (const auto& [name, tensor] : *tensors) held[name] = {tensor.dtype, tensor.shape};
  WeightsFaults faults = CompareParameters(held, expected);
  const std::vector<std::string> extra = std::exchange(faults.extra, {});
  if (!faults.only_extra()) {
    throw InputError("{}: cannot be converted to {}{}; is it the right file?", Where(request), model.name,
                     FaultsText(faults));
  }
  std::erase_if(*tensors, [&](const auto& item) { return !expected.tensors.contains(item.first); });
  if (extra.empty()) return;
  listener(Warning{fmt::format("{}: leaves out {} tensors that are no part of {}: {}", Where(request), extra.size(),
                               model.name, SomeNames(extra))});
}

/// Complains of what no safetensors file can hold.
void CheckTensors(const ConvertRequest& request, const Sources& sources) {
  uint64_t bytes = 0;
  for (const auto& [name, tensor] : sources.tensors) {
    if (!IsUtf8(name) || name == "__metadata__") {
      throw InputError("{}: has a tensor with the name '{}', which safetensors cannot hold; rename it", Where(request),
                       Printable(name));
    }
    if (!ElementBytes(tensor.dtype)) {
      throw InputError("{}: tensor '{}' is of type {}, which safetensors cannot hold; save it as another type",
                       Where(request), Printable(name), tensor.dtype);
    }
    // No tensor has more elements than its storage, so the sum is compared before it could overflow.
    bytes += TensorBytes(tensor.shape, static_cast<uint64_t>(tensor.element_bytes)).value_or(0);
    if (bytes / kMaxGrowth > sources.bytes) {
      throw InputError("{}: its tensors share their numbers and would fill more than {} times the file; refused",
                       Where(request), kMaxGrowth);
    }
  }
}

void Write(const ConvertRequest& request, const Sources& sources) {
  std::map<std::string, TensorLayout> layouts;
  for (const auto& [name, tensor] : sources.tensors) layouts[name] = {tensor.dtype, tensor.shape};
  std::map<std::string, std::string> metadata = {{"source", IsUtf8(sources.names) ? sources.names : "a checkpoint"}};
  if (request.model) metadata["model"] = request.model->name;
  const SafetensorsLayout layout = LayOutSafetensors(layouts, metadata);
  const fs::path folder = request.to.has_parent_path() ? request.to.parent_path() : fs::path(".");
  RequireWritableFolder(folder);
  AtomicFile file(request.to);
  file.Append(layout.beginning);
  for (const std::string& name : layout.order) {
    ForEachPiece(sources.tensors.at(name), [&](std::string_view piece) {
      ThrowIfInterrupted();
      file.Append(piece);
    });
  }
  file.Finish();
}

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

size_t ConvertWeights(const ConvertRequest& request, const Listener& listener) {
  Sources sources = ReadSources(request);
  if (request.model) FitToNetwork(request, &sources.tensors, listener);
  CheckTensors(request, sources);
  Write(request, sources);
  return sources.tensors.size();
}

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
