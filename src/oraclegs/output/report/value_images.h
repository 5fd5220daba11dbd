#pragma once
// Images, for people, of a model's color and of other values.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/core/enum_words.h"
#include "oraclegs/image/image.h"
#include "oraclegs/stages/evaluate_stage.h"

namespace oraclegs {

enum class RenderValue {
  kColor,
  kDepth,        ///< viridis of inverse depth, near is yellow; black where there is no surface
  kNormals,      ///< 255 (n + 1) / 2 of the surface's normal in the camera frame; black where it is unknown
  kSupport,      ///< colors of render/recolor.h, composited
  kUncertainty,  ///< plasma of the error to expect, yellow from kLargestShownError on
};
template <>
struct EnumWords<RenderValue> {
  static constexpr EnumWord<RenderValue> kWords[] = {{RenderValue::kColor, "color"},
                                                     {RenderValue::kDepth, "depth"},
                                                     {RenderValue::kNormals, "normals"},
                                                     {RenderValue::kSupport, "support"},
                                                     {RenderValue::kUncertainty, "uncertainty"}};
};

/// List of the values in "color,depth", each once. Throws UsageError for an unknown or a missing word.
std::vector<RenderValue> ParseRenderValues(const std::string& text);

/// Renders images of several values; values share projections of the Gaussians where possible.
class ValueRenderer {
 public:
  /// Images will be rendered from `cameras`; all get one range of depth, for which some are rendered here. The model
  /// must outlive it. Throws InputError when support or uncertainty is wanted and the model does not have it.
  ValueRenderer(const Model& model, std::vector<RenderValue> values, const std::vector<Camera>& cameras);
  ~ValueRenderer();

  /// RGB image of each value, in their order.
  std::vector<Image8> Render(const Camera& camera);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace oraclegs
