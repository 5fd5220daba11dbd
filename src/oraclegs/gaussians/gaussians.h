#pragma once

#include "oraclegs/core/tensor.h"
#include "oraclegs/gaussians/gaussian_rows.h"

namespace oraclegs {

inline constexpr int kMaxShDegree = 3;
inline constexpr int kShCoefficients = (kMaxShDegree + 1) * (kMaxShDegree + 1);
static_assert(kShFloats == 3 * kShCoefficients);

/// Coefficients of spherical harmonics up to `degree`.
inline constexpr int ShCount(int degree) { return (degree + 1) * (degree + 1); }

/// The raw, unconstrained parameters of N Gaussians (spec/gaussian_core.md 2): contiguous float32 tensors on one
/// device. Also used for anything of the same layout: gradients, moments.
struct Gaussians {
  Tensor means;           ///< [N,3] world units
  Tensor log_scales;      ///< [N,3] ln of the standard deviations in world units
  Tensor quats;           ///< [N,4] w,x,y,z, not normalised
  Tensor opacity_logits;  ///< [N]
  Tensor sh;              ///< [N,16,3] coefficient first, then RGB

  int64_t size() const { return means.defined() ? means.size(0) : 0; }

  /// Uninitialised / zero tensors for n Gaussians.
  static Gaussians Empty(int64_t n);
  static Gaussians Zeros(int64_t n);

  /// Throws ShapeError naming `who` and the tensor that does not fit.
  void Check(const char* who) const;

  /// All rows, of tensors that pass Check.
  GaussianRows Rows() const;

  /// Calls f(name, tensor) for each parameter, in the order above. The names are the checkpoint's.
  template <class F>
  void ForEach(F&& f) {
    f("means", means);
    f("log_scales", log_scales);
    f("quats", quats);
    f("opacity_logits", opacity_logits);
    f("sh", sh);
  }
  template <class F>
  void ForEach(F&& f) const {
    const_cast<Gaussians*>(this)->ForEach([&](const char* name, const Tensor& t) { f(name, t); });
  }
};

}  // namespace oraclegs
