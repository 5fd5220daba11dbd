#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>

#include "oraclegs/settings/plan.h"
#include "oraclegs/settings/run_size.h"

namespace oraclegs {

/// Free memory of a device in bytes; 0 = unknown.
using FreeMemory = std::function<int64_t(Device)>;

/// Throws what Stable Virtual Camera and VGGT would throw in their stages, before anything is computed: UsageError for
/// more photos than --seva-frames has room for, RunError where the device's memory does not hold a pass, with the
/// options that help. Leaves out what `done`, the records of finished stages, has a result of. options: with their
/// size.
void RequireNetworkNeeds(const RunOptions& options, const Plan& plan, const SceneSize& scene,
                         const nlohmann::json& done, const FreeMemory& free = FreeBytes);

}  // namespace oraclegs
