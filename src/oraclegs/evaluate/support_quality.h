#pragma once
// Does the support of the Gaussians say where a render is wrong?

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "oraclegs/gaussians/gaussians.h"
#include "oraclegs/render/recolor.h"
#include "oraclegs/render/render.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {

/// How the errors of test views depend on the support rendered there.
struct SupportQuality {
  struct Class {
    double share = 0;       ///< of the pixels
    double mean_error = 0;  ///< |render - truth|, mean over the channels; NaN without pixels
  };
  std::array<Class, kSupportClasses> classes;  ///< by SupportClass
  double auroc = 0;  ///< of low support as a sign of an error above kLargeError; NaN when none or all are
  int64_t pixels = 0;

  /// Both of all pixels together, of one length.
  static SupportQuality FromPixels(const std::vector<float>& error, const std::vector<float>& support);
};

/// The quality at the views: each view's render, and the support of the Gaussians blended like a color on 0, so that a
/// hole has none. Of very many pixels every n-th. Pixels of alpha below 0.1, where nothing is drawn, and masked ones
/// are left out. `support`: [N]. The device is that of the Gaussians.
SupportQuality MeasureSupport(const Gaussians& gaussians, const std::vector<float>& support,
                              const std::vector<LoadedView>& views, const RenderOptions& options);

/// {"auroc", "pixels", "classes": [{"name", "share", "mean_error"}]}, the best supported class first; NaN becomes null.
nlohmann::json ToJson(const SupportQuality& quality);

}  // namespace oraclegs
