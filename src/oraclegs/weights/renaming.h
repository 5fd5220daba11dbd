#pragma once
// From the names in published files to those of our networks.

#include <string>

#include "oraclegs/weights/checkpoint/stored_tensor.h"

namespace oraclegs {

/// The name that a tensor of a published file has in the network with this list of parameters
/// (WeightsInfo::parameters).
std::string NameInNetwork(const std::string& parameters, const std::string& published);

/// The shape that a tensor has there: older files of the autoencoder store the matrices of its attention, here under
/// their new names, as convolutions of 1x1.
StoredTensor ShapedForNetwork(const std::string& parameters, const std::string& name, StoredTensor tensor);

}  // namespace oraclegs
