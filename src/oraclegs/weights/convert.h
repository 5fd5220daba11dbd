#pragma once
// Published weights become one safetensors file, without PyTorch and without running what a file says.

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/weights/checkpoint/stored_tensor.h"
#include "oraclegs/weights/registry.h"

namespace oraclegs {

struct ConvertRequest {
  std::vector<std::filesystem::path> files;  ///< what ReadPublishedCheckpoint reads; several become one
  std::filesystem::path to;                  ///< its folder is made
  std::string key = {};                      ///< where in the files the state dict is, if nowhere usual
  const WeightsInfo* model = nullptr;        ///< nullptr: all tensors keep their names
};

/// Writes the tensors of the files, with their numbers and types as they are; `to` appears when it is whole. For a
/// model they get the names that its network asks for: a tensor that is missing or has another shape or type is an
/// error, others are left out with a Warning. Returns how many were written. Throws InputError naming the file,
/// RunError (disk full), Interrupted.
size_t ConvertWeights(const ConvertRequest& request, const Listener& listener);

/// The name that a tensor of a published file has in the network with this list of parameters
/// (WeightsInfo::parameters).
std::string NameInNetwork(const std::string& parameters, const std::string& published);

/// The shape that a tensor has there: older files of the autoencoder store the matrices of its attention, here under
/// their new names, as convolutions of 1x1.
StoredTensor ShapedForNetwork(const std::string& parameters, const std::string& name, StoredTensor tensor);

}  // namespace oraclegs
