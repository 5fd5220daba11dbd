#pragma once
// Quality of the support of Gaussians as a sign of where a render is wrong.

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "oraclegs/gaussians/gaussians.h"
#include "oraclegs/render/recolor.h"
#include "oraclegs/render/render.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {

/// Errors of test views by the support rendered there.
struct SupportQuality {
  struct Class {
    double share = 0;       ///< fraction of the pixels
    double mean_error = 0;  ///< |render - truth|, mean over the channels; NaN without pixels
  };
  std::array<Class, kSupportClasses> classes;  ///< by SupportClass
  double auroc = 0;  ///< AUROC of low support as a sign of an error above kLargeError; NaN when none or all are
  int64_t pixels = 0;

  /// Quality from the errors and supports of all pixels, lists of one length.
  static SupportQuality FromPixels(const std::vector<float>& error, const std::vector<float>& support);
};

/// Quality at the views: each view's render against its image, with the support of the Gaussians blended like a color
/// on 0, so that a hole has none. Very many pixels are subsampled evenly. Pixels of alpha below 0.1, where nothing is
/// drawn, and masked ones are left out. `support`: [N]. The device is that of the Gaussians.
SupportQuality MeasureSupport(const Gaussians& gaussians, const std::vector<float>& support,
                              const std::vector<LoadedView>& views, const RenderOptions& options);

/// The quality as JSON: {"auroc", "pixels", "classes": [{"name", "share", "mean_error"}]}, the best supported class
/// first; NaN becomes null.
nlohmann::json ToJson(const SupportQuality& quality);

}  // namespace oraclegs
