#pragma once
// A photo or a proposal as the trainer uses it.

#include <memory>
#include <string>
#include <vector>

#include "oraclegs/camera/camera.h"
#include "oraclegs/core/buffer.h"
#include "oraclegs/scene/loaded_view.h"
#include "oraclegs/train/exposure.h"

namespace oraclegs {

/// A training image on the device.
struct TrainView {
  std::string name;
  Camera camera;
  Buffer<float> image;  ///< [H,W,3]
  /// Weight of each pixel, [H,W] in [0,1], undefined = 1 everywhere: the mask of a photo, the confidence U of a
  /// proposal. WeightByCovisibility may set weights of photos above 1.
  Buffer<float> pixel_weight;
  Buffer<float> inv_depth = {};   ///< [H,W] 1/z, 1/world unit, 0 = empty; undefined = the view has no known depth
  Buffer<float> depth_mask = {};  ///< [H,W] in [0,1], weight of inv_depth, 0 = unknown; defined where inv_depth is
  Buffer<float> alpha = {};       ///< [H,W] in [0,1], fraction of the pixel that the scene covers; undefined = unknown
  ExposureMap exposure = kIdentityExposure;  ///< start of the photo's exposure map, when that is trained
  /// In place of image and pixel_weight, of which they need a quarter of the memory: byte / 255.
  Buffer<uint8_t> image_bytes = {}, weight_bytes = {};

  bool HasWeights() const { return pixel_weight.defined() || weight_bytes.defined(); }
  /// The image and the weights as floats, the latter undefined where they are 1 everywhere; new ones where they are
  /// held as bytes.
  Buffer<float> Image() const;
  Buffer<float> Weights() const;
};

/// Writes byte / 255 of each byte; of the same shape.
void UnpackBytes(const Buffer<uint8_t>& bytes, const Buffer<float>& to);

/// Converts a photo, without depth; with alpha where the photo has any. With an `owner`, which keeps the photo, its
/// image is shown, else copied. Throws ShapeError when the photo's buffers do not fit its size.
TrainView ToTrainView(const LoadedView& photo, std::shared_ptr<const void> owner = nullptr);

/// Throws UsageError when there is no view; ShapeError when a tensor does not fit its camera or stands twice, when only
/// one of inv_depth and depth_mask is defined, when an inverse depth of positive mask is not finite, or when an alpha
/// is not in [0, 1].
void CheckViews(const std::vector<TrainView>& views);

/// Throws as CheckViews for proposals, but allows none; also throws ShapeError where a confidence is not in [0, 1].
void CheckProposals(const std::vector<TrainView>& proposals);

/// Mean over the pixels; 1 for a view without weights.
double MeanConfidence(const TrainView& view);

/// Cameras of the views, in their order.
std::vector<Camera> Cameras(const std::vector<TrainView>& views);

/// The proposal with pixel_weight^power; pixels of weight 0 stay 0. The tensors of `proposal` are not written.
TrainView WithConfidencePower(TrainView proposal, double power);

/// The view with depth only where its photo is unmasked (pixel_weight > 0), and zero elsewhere, so that values under
/// the mask, NaN included, have no effect. A depth that is masked everywhere is dropped. The tensors of `view` are not
/// written.
TrainView WithCleanDepth(TrainView view);

/// Typical distance of the scene: 1 / m, m the median over the views of the median inverse depth over the unmasked
/// pixels. 0 when no view has depth. Expects views as WithCleanDepth returns them.
///
/// It is the unit of the depth term: weight * CharacteristicDepth * mean(|1/z - 1/z*| M) does not change when poses and
/// depths are measured in another unit, and is the term of [Kerbl 2024] where the characteristic depth is 1.
double CharacteristicDepth(const std::vector<TrainView>& views);

}  // namespace oraclegs
