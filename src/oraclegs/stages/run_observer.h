#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "oraclegs/core/function_ref.h"
#include "oraclegs/train/observer.h"

namespace oraclegs {

struct Run;  // stages/stage.h

/// How the test views are scored while a model is trained.
struct TestScore {
  int64_t every = 0;                                            ///< iterations; 0 = never
  std::function<double(const Gaussians& gaussians)> psnr = {};  ///< dB, mean over the views

  bool IsDue(int64_t iteration, int64_t total) const {
    return every > 0 && iteration > 0 && (iteration % every == 0 || iteration == total);
  }
};

inline constexpr char kPhotosRead[] = "photos";  ///< for RunObserver::Show, before the first stage

/// Watches a run for those that look on. Nothing of it changes a result or ends a run.
class RunObserver {
 public:
  virtual ~RunObserver() = default;
  /// Is called where there is more to see: with kPhotosRead, with the name of a stage that is finished, and with
  /// "train" as training begins.
  virtual void Show(Run* run, const std::string& stage) = 0;
  /// Returns the observer of one training, from the start or from a checkpoint; valid as long as this object lives.
  virtual TrainObserver OfTraining(TestScore score) = 0;
  /// Runs `body`; what it throws is the end of the run, and goes on.
  virtual void Guard(FunctionRef<void()> body) = 0;
};

/// Runs `body` guarded by `observer`, which may be null.
inline void Guarded(RunObserver* observer, FunctionRef<void()> body) { observer ? observer->Guard(body) : body(); }

}  // namespace oraclegs
