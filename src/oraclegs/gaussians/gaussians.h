#pragma once

#include "oraclegs/core/buffer.h"
#include "oraclegs/gaussians/gaussian_rows.h"

namespace oraclegs {

inline constexpr int kMaxShDegree = 3;
inline constexpr int kShCoefficients = (kMaxShDegree + 1) * (kMaxShDegree + 1);
static_assert(kShFloats == 3 * kShCoefficients);

/// Coefficients of spherical harmonics up to `degree`.
inline constexpr int ShCount(int degree) { return (degree + 1) * (degree + 1); }

/// The raw, unconstrained parameters of N Gaussians (docs/method.md#gaussian-parameters): float32 buffers on one
/// device. Also used for anything of the same layout: gradients, moments.
struct Gaussians {
  Buffer<float> means;           ///< [N,3] world units
  Buffer<float> log_scales;      ///< [N,3] ln of the standard deviations in world units
  Buffer<float> quats;           ///< [N,4] w,x,y,z, not normalized
  Buffer<float> opacity_logits;  ///< [N]
  Buffer<float> sh;              ///< [N,16,3] coefficient first, then RGB

  int64_t size() const { return means.defined() ? means.size(0) : 0; }

  /// Uninitialized / zero parameters of n Gaussians.
  static Gaussians Empty(int64_t n, Device device = kCpu);
  static Gaussians Zeros(int64_t n, Device device = kCpu);

  /// Throws ShapeError naming `who` and the buffer that does not fit.
  void Check(const char* who) const;

  /// All rows, of buffers that pass Check.
  GaussianRows Rows() const;

  Device device() const { return means.device(); }
  /// A copy in new memory / the numbers on the device, in new memory unless they lie there.
  Gaussians Clone() const;
  Gaussians To(Device device) const;

  /// Calls f(name, buffer) for each parameter, in the order above. The names are the checkpoint's.
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
    f("means", means);
    f("log_scales", log_scales);
    f("quats", quats);
    f("opacity_logits", opacity_logits);
    f("sh", sh);
  }
};

/// to += the rows [begin, end) of `from`, where row 0 of `to` belongs to `begin`; of sh the first `sh_floats` of each.
void AddRows(const Gaussians& from, int64_t begin, int64_t end, int sh_floats, const GaussianRows& to);

}  // namespace oraclegs
