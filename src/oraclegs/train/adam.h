#pragma once

#include "oraclegs/gaussians/gaussians.h"
#include "oraclegs/train/step_constants.h"

namespace oraclegs {

/// A step of Adam that has begun: Update for all Gaussians, once each, makes it whole.
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
/// (docs/method.md#adam). SH coefficients above the active degree have neither gradient nor moments and are
/// skipped, which is the same.
///
/// The moments of SH can take less memory (ShMoments). Half: both are rounded to bfloat16 between steps, the second one
/// up or down at random, in the mean exactly, since a step changes it by less than a bfloat16 number can. Compact: only
/// the first is kept for each coefficient, also in bfloat16. The square of a Gaussian's SH gradients is taken in the
/// mean over its coefficients, which is that of the constant one (MeanShSquare), so that all share one second moment.
struct Adam {
  Gaussians m, v;              ///< first and second moments; sh undefined unless full
  Buffer<uint16_t> sh_m;       ///< [N,16,3] bfloat16; undefined where full
  Buffer<uint16_t> sh_v_half;  ///< [N,16,3] bfloat16; undefined unless half
  Buffer<float> sh_v;          ///< [N]; undefined unless compact
  int64_t step = 0;            ///< steps taken

  /// Moments of 0.
  explicit Adam(int64_t n, ShMoments sh_moments = ShMoments::kFull);

  int64_t size() const { return m.size(); }
  ShMoments sh_moments() const {
    return sh_v.defined() ? ShMoments::kCompact : sh_v_half.defined() ? ShMoments::kHalf : ShMoments::kFull;
  }
  MomentRows Rows() const;
  /// Throws ShapeError naming `who` unless these are the moments of n Gaussians.
  void Check(const char* who, int64_t n) const;
  /// In new memory.
  Adam Clone() const;
  /// Adds rows of zeros, n in all; in place where memory has room (Buffer::GrownTo).
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
  /// The same for devices that take the step themselves.
  AdamConstants BeginStep(const LearningRates& rates, int sh_degree, const Gaussians& params);

  /// A whole step, on all threads.
  void Step(const Gaussians& grads, const LearningRates& rates, int sh_degree, Gaussians* params);

  /// A step of one group alone, say &Gaussians::means: of the others neither values nor moments change, as in PyTorch,
  /// which leaves parameters without gradient alone. On all threads. Throws ShapeError.
  ///
  /// PyTorch counts the steps of each parameter. Here `step` stays as it is and counts the whole steps: the other
  /// groups move to the bit as if this step had not been. This group's moments are corrected by that count, too, which
  /// is below its own. With one step more for every ten whole ones its steps differ by 5 % at most from PyTorch's, with
  /// one for each whole one by a third at first and less than 3 % after 3000.
  void StepGroup(Buffer<float> Gaussians::*group, const Gaussians& grads, double rate, Gaussians* params);
};

}  // namespace oraclegs
