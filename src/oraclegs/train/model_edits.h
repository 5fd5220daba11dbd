#pragma once
// Edits of a model that lies on any device, made on the host: for densifiers and parts of methods.

#include <cstdint>
#include <functional>
#include <vector>

#include "oraclegs/train/train_device.h"

namespace oraclegs {

/// Calls `edit` with the model on the host: with the model itself on a CPU, else with a copy that replaces it
/// afterwards, in the device's memory where that has room (Buffer::GrownTo).
void OnHost(TrainedModel* model, const std::function<void(TrainedModel*)>& edit);

/// Keeps the Gaussians of these rows, with their moments, in this order. On a CPU in new memory, on a GPU in the memory
/// that there is where that has room.
void KeepRows(const std::vector<int64_t>& rows, Gaussians* gaussians, Adam* adam);

}  // namespace oraclegs
