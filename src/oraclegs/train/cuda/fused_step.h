#pragma once

#include "oraclegs/render/cuda/gaussian_backward.h"
#include "oraclegs/train/cuda/step.h"

namespace oraclegs::cuda {

/// Queues the last stage of the backward pass and, of each gradient while it is in registers, the step: what RunStep
/// does, without a gradient going through memory. `step` begins with Gaussian 0 and moves the parameters that `in`
/// reads.
void RunFusedStep(const GaussianBackwardInput& in, const StepConstants& step, cudaStream_t stream);

}  // namespace oraclegs::cuda
