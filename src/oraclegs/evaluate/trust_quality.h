#pragma once
// Whether a model is right about where it can be trusted: its support and its uncertainty against errors of renders.

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "oraclegs/evaluate/error_bound.h"
#include "oraclegs/evaluate/oracle_quality.h"
#include "oraclegs/evaluate/sparsification.h"
#include "oraclegs/evaluate/uncertainty.h"
#include "oraclegs/gaussians/gaussians.h"
#include "oraclegs/gaussians/selection.h"
#include "oraclegs/render/recolor.h"
#include "oraclegs/render/render.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {

/// Errors of test views by the support rendered there: where what they show comes from.
struct SupportQuality {
  struct Class {
    double share = 0;       ///< fraction of the pixels
    double mean_error = 0;  ///< ColorError (image/color_error.h); NaN without pixels
  };
  std::array<Class, kSupportClasses> classes;  ///< by SupportClass
  int64_t pixels = 0;

  /// Quality from the errors and supports of all pixels, lists of one length.
  static SupportQuality FromPixels(const std::vector<float>& error, const std::vector<float>& support);
};

/// The quality as JSON: {"pixels", "classes": [{"name", "share", "mean_error"}]}, the best supported class first; NaN
/// becomes null.
nlohmann::json ToJson(const SupportQuality& quality);

/// How an uncertainty predicts the errors of images. The confidence that belongs to it is its ExpectedSimilarity
/// (image/similarity.h).
struct UncertaintyQuality {
  OracleQuality pixels;         ///< of all images together
  PublishedAuse pooled, means;  ///< as other papers compute it, of all pixels together and as the mean of the images
};

/// As ToJson of the pixels, with "published_ause": {"pooled", "images"}.
nlohmann::json ToJson(const UncertaintyQuality& quality);

/// Qualities of what is known of a model; nothing for what is not known.
struct TrustQuality {
  std::optional<SupportQuality> support;
  std::optional<UncertaintyQuality> of_gaussians;  ///< quality of the mark
  std::optional<UncertaintyQuality> of_models;     ///< quality of the models' differences at each pixel
  std::vector<ExpectedErrors> errors_of_models;    ///< each view's, where `models` is given
};

/// Quality at the views: each view's render against its image (ErrorsOf), with the marks of the Gaussians blended like
/// a color. A hole has no support; uncertainty is divided by alpha. Very many pixels are subsampled evenly. `models`
/// compares the same model with others; null = it has none. The device is that of the Gaussians.
TrustQuality MeasureTrust(const Gaussians& gaussians, const GaussianMarks& marks, const std::vector<LoadedView>& views,
                          const RenderOptions& options, Uncertainty* models = nullptr);

/// The errors of a model at views that it has not seen, and those that it expects itself: with stand-ins for other
/// models, which may have seen them.
std::vector<ExpectedErrors> ErrorsAtUnseen(const Gaussians& gaussians, const std::vector<LoadedView>& views,
                                           const RenderOptions& options);

}  // namespace oraclegs
