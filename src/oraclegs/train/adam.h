#pragma once

#include "oraclegs/gaussians/gaussians.h"
#include "oraclegs/train/step_constants.h"

namespace oraclegs {

/// A step of Adam that has begun. It is complete when Update has seen every Gaussian once.
class AdamStep {
 public:
  /// params -= lr * m_hat / (sqrt(v_hat) + eps) for Gaussians [begin, end), in place. `grads` holds their rows, the
  /// first one for `begin`. Different blocks may be updated from several threads at once; how they are cut changes no
  /// bit.
  void Update(int64_t begin, int64_t end, const GaussianRows& grads) const;

 private:
  friend struct Adam;
  AdamStep(const AdamConstants& constants, const GaussianRows& params, const MomentRows& moments)
      : constants_(constants), params_(params), moments_(moments) {}

  AdamConstants constants_;
  GaussianRows params_;
  MomentRows moments_;
};

/// Adam with beta 0.9, 0.999, epsilon 1e-15 outside the root, one step counter, every Gaussian in every step
/// (docs/method.md#adam). SH coefficients above the active degree have neither gradient nor moments and are skipped,
/// which gives the same result.
///
/// SH moments can take less memory (ShMoments). Half: both moments are rounded to bfloat16 between steps; the second is
/// rounded up or down at random, exact in the mean, since a step changes it by less than bfloat16 resolves. Compact:
/// each coefficient keeps only its first moment, in bfloat16. The squares of a Gaussian's SH gradients are averaged
/// over its coefficients; that mean follows from the constant coefficient (MeanShSquare), so that all coefficients
/// share one second moment.
struct Adam {
  Gaussians m, v;              ///< first and second moments; sh undefined unless full
  Buffer<uint16_t> sh_m;       ///< [N,16,3] bfloat16; undefined where full
  Buffer<uint16_t> sh_v_half;  ///< [N,16,3] bfloat16; undefined unless half
  Buffer<float> sh_v;          ///< [N]; undefined unless compact
  int64_t step = 0;            ///< steps taken

  /// Makes n rows of zero moments.
  explicit Adam(int64_t n, ShMoments sh_moments = ShMoments::kFull);

  int64_t size() const { return m.size(); }
  ShMoments sh_moments() const {
    return sh_v.defined() ? ShMoments::kCompact : sh_v_half.defined() ? ShMoments::kHalf : ShMoments::kFull;
  }
  MomentRows Rows() const;
  /// Throws ShapeError naming `who` unless these are the moments of n Gaussians.
  void Check(const char* who, int64_t n) const;
  /// Deep copy in new memory.
  Adam Clone() const;
  /// Appends rows of zeros up to n in all; in place where memory has room (Buffer::GrownTo).
  void GrowTo(int64_t n);

  /// Calls f(moment, name, buffer) for each buffer that is defined; moment is "m" or "v", name that of the parameters
  /// (Gaussians::ForEach). The buffers are of floats, or of bfloat16 numbers.
  template <class F>
  void ForEachMoment(F&& f) {
    for (Gaussians* moment : {&m, &v}) {
      moment->ForEach([&](const char* name, Buffer<float>& buffer) {
        if (buffer.defined()) f(moment == &m ? "m" : "v", name, buffer);
      });
    }
    if (sh_m.defined()) f("m", "sh", sh_m);
    if (sh_v_half.defined()) f("v", "sh", sh_v_half);
    if (sh_v.defined()) f("v", "sh", sh_v);
  }

  /// Begins the next step. The result writes to `params` and to the moments; none of them may be replaced while it is
  /// used. Throws ShapeError.
  AdamStep BeginStep(const LearningRates& rates, int sh_degree, Gaussians* params);
  /// Begins the next step for a device that takes the step itself. Throws ShapeError.
  AdamConstants BeginStep(const LearningRates& rates, int sh_degree, const Gaussians& params);

  /// Takes a whole step, on all threads.
  void Step(const Gaussians& grads, const LearningRates& rates, int sh_degree, Gaussians* params);

  /// Takes a step of one group alone, say &Gaussians::means. Values and moments of the other groups stay, as PyTorch
  /// leaves parameters without gradient alone. On all threads, for buffers of any device. Throws ShapeError.
  ///
  /// PyTorch counts the steps of each parameter. Here `step` is unchanged and counts the whole steps, so the other
  /// groups keep their bits. This group's moments are corrected by that count, which is below its own: its steps differ
  /// from PyTorch's by at most 5 % with one extra step every ten whole ones; with one for each whole step by a third at
  /// first and by less than 3 % after 3000.
  void StepGroup(Buffer<float> Gaussians::*group, const Gaussians& grads, double rate, Gaussians* params);
};

}  // namespace oraclegs
