#pragma once

#include <functional>

#include "oraclegs/core/buffer.h"

namespace oraclegs {

/// LPIPS(render, target) of two images [H,W,3] in [0,1]. Adds weight * dLPIPS/d(render) to grad [H,W,3]; undefined =
/// value only. An empty function stands for no network.
using PerceptualDistance =
    std::function<double(const Buffer<float>& render, const Buffer<float>& target, double weight, Buffer<float>* grad)>;

}  // namespace oraclegs
