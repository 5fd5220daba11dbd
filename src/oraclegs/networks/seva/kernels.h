#pragma once
// What lies between the products of SEVA's UNet as kernels of our own (networks/cuda), which read and write memory once
// where libtorch's operations do so several times. For bfloat16 on a GPU, in a build with CUDA: elsewhere, and for
// shapes that a kernel does not take, each gives an undefined tensor and has done nothing.

#include "oraclegs/networks/seva/norm_types.h"

namespace oraclegs::seva::kernels {

/// Whether they take numbers of x's type, where they lie.
bool CanTake(const Tensor& x);

/// both [..., 2 C], values and then gates -> values * GELU(gates) [..., C].
Tensor GatedGelu(const Tensor& both);

/// *sum = x + addend, where *sum may be x, and is made when undefined. Returns it.
Tensor Sum(const Tensor& x, const Addend& addend, Tensor* sum);
/// The same, and returns the sum's layer norm.
Tensor NormOfSum(const Tensor& x, const Addend& addend, const LayerNorm& norm, Tensor* sum);

/// x [B, C, h, w] with channels last -> the same, normalized and changed as `around` says.
Tensor NormMap(const GroupNorm& layer, const Tensor& x, bool silu, const AroundNorm& around);

/// qkv [B, frames, pixels, 3 C], queries, keys and values -> [B, frames, pixels, C]: attention over the frames at one
/// pixel.
Tensor AttendAcrossFrames(const Tensor& qkv, int64_t heads);

}  // namespace oraclegs::seva::kernels
