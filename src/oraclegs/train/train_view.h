#pragma once
// What the trainer knows of one photo, or of one proposal.

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
  /// [H,W] in [0,1], undefined = 1 everywhere; a mask for photos, U for proposals. WeightByCovisibility makes it a
  /// weight of photos, which may exceed 1.
  Buffer<float> confidence;
  Buffer<float> inv_depth =
      {};  ///< [H,W] 1/z, 1/world unit, 0 = nothing is there; undefined = no depth of this view is known
  Buffer<float> depth_mask =
      {};                    ///< [H,W] in [0,1], how much inv_depth counts, 0 = unknown; defined where inv_depth is
  Buffer<float> alpha = {};  ///< [H,W] in [0,1], how much of the pixel the scene covers; undefined = unknown
  ExposureMap exposure = kIdentityExposure;  ///< where its exposure starts from, when that is trained
};

/// Without depth; with alpha where the photo has any. Throws ShapeError when the photo's buffers do not fit its size.
TrainView ToTrainView(const LoadedView& photo);

/// Throws UsageError when there is no view, ShapeError when a tensor does not fit its camera, when only one of
/// inv_depth and depth_mask is there, when an inverse depth that counts is not finite, or an alpha not in [0, 1].
void CheckViews(const std::vector<TrainView>& views);

/// The same of proposals, of which there may be none; also throws ShapeError where a confidence is not in [0, 1].
void CheckProposals(const std::vector<TrainView>& proposals);

/// Mean over the pixels; 1 where it is undefined, which stands for 1 everywhere.
double MeanConfidence(const Buffer<float>& confidence);

/// Where the views were taken from, in their order.
std::vector<Camera> Cameras(const std::vector<TrainView>& views);

/// The proposal whose pixels of less confidence than `gate` count nothing, and the others confidence^power; what has no
/// confidence never counts. The tensors of `proposal` are not written.
TrainView WithGatedConfidence(TrainView proposal, double gate, double power);

/// The same view whose depth counts only where its photo does (confidence > 0) and is zero where it does not
/// count, so that what stands there, also what is not a number, reaches nothing. A depth that counts nowhere is
/// dropped. The tensors of `view` are not written.
TrainView WithCleanDepth(TrainView view);

/// The distance a scene has on the whole: 1 / m, m the median over the views of the median inverse depth over the
/// pixels that count. 0 when no view has depth. Views as WithCleanDepth leaves them.
///
/// It is the unit of the depth term: weight * CharacteristicDepth * mean(|1/z - 1/z*| M) does not change when poses and
/// depths are measured in another unit, and is the term of [Kerbl 2024] where the characteristic depth is 1.
double CharacteristicDepth(const std::vector<TrainView>& views);

}  // namespace oraclegs
