#pragma once
// What can be rendered of a model beside its color, as images for people.

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
  kDepth,    ///< viridis of inverse depth, near is yellow; black where nothing is
  kNormals,  ///< 255 (n + 1) / 2 of the surface's normal in the camera frame; black where it is not known
  kSupport,  ///< the colors of render/recolor.h, composited
};
template <>
struct EnumWords<RenderValue> {
  static constexpr EnumWord<RenderValue> kWords[] = {{RenderValue::kColor, "color"},
                                                     {RenderValue::kDepth, "depth"},
                                                     {RenderValue::kNormals, "normals"},
                                                     {RenderValue::kSupport, "support"}};
};

/// "color,depth" as a list, each value once. Throws UsageError for an unknown or a missing word.
std::vector<RenderValue> ParseRenderValues(const std::string& text);

/// Renders images of several values, each Gaussian projected as seldom as possible.
class ValueRenderer {
 public:
  /// `cameras`: where images will be rendered from, for one range of depth in all of them. Renders some of them. The
  /// model must live as long. Throws InputError when support is wanted and the model has none.
  ValueRenderer(const Model& model, std::vector<RenderValue> values, const std::vector<Camera>& cameras);
  ~ValueRenderer();

  /// An RGB image of each value, in their order.
  std::vector<Image8> Render(const Camera& camera);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace oraclegs
