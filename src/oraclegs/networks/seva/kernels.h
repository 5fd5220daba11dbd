#pragma once
// Our own kernels (networks/cuda) for the operations between the matrix products of SEVA's UNet. They read and write
// memory once where libtorch's operations do so several times. They need bfloat16 on a GPU and a build with CUDA;
// otherwise, and for shapes that a kernel does not take, each function does nothing and returns an undefined tensor.

#include "oraclegs/networks/seva/norms.h"

namespace oraclegs::seva::kernels {

/// True when the kernels take x's type and device.
bool CanTake(const Tensor& x);

/// both [..., 2 C], values, then gates -> values * GELU(gates) [..., C].
Tensor GatedGelu(const Tensor& both);

/// Returns *sum = x + addend. *sum may be x; it is made when undefined.
Tensor Sum(const Tensor& x, const Addend& addend, Tensor* sum);
/// Layer norm of *sum = x + addend, which is stored as by Sum.
Tensor NormOfSum(const Tensor& x, const Addend& addend, const LayerNorm& norm, Tensor* sum);

/// x [B, C, h, w] with channels last -> its group norm with the changes that `around` names.
Tensor NormMap(const GroupNorm& layer, const Tensor& x, bool silu, const AroundNorm& around);

/// qkv [B, frames, pixels, 3 C], queries, keys and values -> [B, frames, pixels, C]: attention over the frames at one
/// pixel.
Tensor AttendAcrossFrames(const Tensor& qkv, int64_t heads);

}  // namespace oraclegs::seva::kernels
