#pragma once

#include "oraclegs/train/cuda/device_views.h"
#include "oraclegs/train/densify.h"

namespace oraclegs::cuda {

/// Makes the densifier of 3DGS-MCMC on a GPU, with memory for `capacity` Gaussians. `views` are the plan's on the
/// device and outlive it.
std::unique_ptr<Densifier> MakeCudaMcmcDensifier(const DensifierSetup& setup, const DeviceViews& views,
                                                 int64_t capacity);

}  // namespace oraclegs::cuda
