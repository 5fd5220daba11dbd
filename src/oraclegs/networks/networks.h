#pragma once
// Networks as the program sees them: interfaces to a library of their own, which uses libtorch and is loaded when a
// network is asked for (loader.h). This folder is in every build; its subfolders are that library.
//
// Memory is shared where both sides compute on one device: a Buffer becomes a tensor and back without a copy.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/camera/camera.h"
#include "oraclegs/core/buffer.h"
#include "oraclegs/core/enum_words.h"
#include "oraclegs/core/options.h"
#include "oraclegs/core/progress.h"
#include "oraclegs/image/image.h"
#include "oraclegs/networks/seva_options.h"
#include "oraclegs/networks/seva_size.h"

namespace oraclegs {

struct LoadedView;

/// "Depth Anything V2 small", "base", "large", or "of another size", read from the header of the weights without
/// loading any library. Throws InputError for a file of another network.
std::string DepthNetworkName(const std::filesystem::path& weights);

/// Depth Anything V2: from one image to relative inverse depth.
class DepthNetwork {
 public:
  virtual ~DepthNetwork() = default;
  /// Inverse depth [height, width] on the host; larger is nearer, unit and zero point are unknown.
  virtual Buffer<float> InverseDepth(const ImageF& rgb) const = 0;
  /// Returns dL/d(rgb) [height, width, 3] of a loss L of the inverse depth of rgb [height, width, 3], both on the host.
  /// `gradient` takes that depth and returns dL/d(depth).
  virtual Buffer<float> ImageGradient(const Buffer<float>& rgb,
                                      const std::function<Buffer<float>(const Buffer<float>&)>& gradient) const = 0;
};

/// Keypoints of an image, best first: points that are found again in other images of the same place.
struct ImageFeatures {
  std::vector<Eigen::Vector2f> keypoints;  ///< pixels from the image's top-left corner
  std::vector<float> scores;               ///< in (0, 1), of each keypoint
  Buffer<float> descriptors;               ///< [keypoints, size] of unit length, on the host
};

struct KeypointOptions {
  double min_score = 0.2;        ///< in (0, 1)
  int64_t max_keypoints = 4096;  ///< the best are kept
  int64_t max_side = 1600;       ///< pixels of the longer side to which a larger image is reduced
};

/// ALIKED: keypoints of images, and descriptors by which they are matched.
class KeypointNetwork {
 public:
  virtual ~KeypointNetwork() = default;
  virtual int64_t descriptor_size() const = 0;
  virtual ImageFeatures Find(const ImageF& rgb, const KeypointOptions& options) const = 0;
};

/// Range of the values that LPIPS reads. The two give different scores, and both are in use.
enum class LpipsRange {
  kZeroOne,      ///< the image in [0, 1] as it is: training losses and scores of the 3DGS family
  kMinusOneOne,  ///< 2 x - 1: what the authors of LPIPS ask for
};

/// LPIPS of two images [H, W, 3] in [0, 1]. Buffers may lie on the host or on the network's device.
class PerceptualNetwork {
 public:
  virtual ~PerceptualNetwork() = default;
  virtual std::string name() const = 0;       ///< "VGG16" or "AlexNet"
  virtual int64_t smallest_side() const = 0;  ///< shorter side that an image must have, pixels
  /// Throws ShapeError for images of different sizes or smaller than smallest_side().
  virtual double Score(const Buffer<float>& image, const Buffer<float>& target, LpipsRange range) const = 0;
  /// Score with kZeroOne; adds weight * d(score)/d(image) to grad [H, W, 3], null or undefined = score only. The
  /// target's features stay in the cache while there is room: its numbers must not change.
  virtual double Loss(const Buffer<float>& image, const Buffer<float>& target, double weight,
                      Buffer<float>* grad) const = 0;
};

/// Queries whose attention counts as support of a proposal.
enum class AttentionMode {
  kOfficial,   ///< the camera token of the reference; minimum and maximum over all views of the pass together
  kReference,  ///< the patches of the reference
  kOthers,     ///< the patches of all other views of the pass
};
template <>
struct EnumWords<AttentionMode> {
  static constexpr EnumWord<AttentionMode> kWords[] = {{AttentionMode::kOfficial, "official"},
                                                       {AttentionMode::kReference, "reference"},
                                                       {AttentionMode::kOthers, "others"}};
};

/// Number type of VGGT's aggregator.
enum class VggtPrecision {
  kFloat32,
  kBFloat16,
  kAutocast  ///< as its authors run it: weights and sums in float32, products in bfloat16
};
template <>
struct EnumWords<VggtPrecision> {
  static constexpr EnumWord<VggtPrecision> kWords[] = {{VggtPrecision::kFloat32, "float32"},
                                                       {VggtPrecision::kBFloat16, "bfloat16"},
                                                       {VggtPrecision::kAutocast, "autocast"}};
};

/// bfloat16 on a GPU, whose matrix units are made for it, else float32.
inline VggtPrecision UsualVggtPrecision(bool on_gpu) {
  return on_gpu ? VggtPrecision::kBFloat16 : VggtPrecision::kFloat32;
}

/// Layer of VGGT's global attention, counted from 0, and the weight of its map.
struct LayerWeight {
  int64_t layer = 0;
  double weight = 1;
};

struct AttentionOptions {
  AttentionMode mode = AttentionMode::kReference;
  std::vector<LayerWeight> layers = {};  ///< weights >= 0, not all 0; empty = the file's own, else 0 and 22
  VggtPrecision precision = VggtPrecision::kFloat32;
};

/// VGGT's aggregator: how much the other images of a scene attend to each pixel of an image.
class AttentionNetwork {
 public:
  virtual ~AttentionNetwork() = default;
  /// Bytes that a pass over `views` images needs on the device, weights included, for the largest of the cameras'
  /// sizes. Reads no weights.
  virtual int64_t PassBytes(const std::vector<Camera>& cameras, int64_t views) const = 0;
  /// Reads the weights; otherwise the first Confidence does. Throws InputError that lists all that does not fit.
  virtual void Load() = 0;
  /// Runs one pass over `views`, the first of which is the reference. Returns for each index in `asked` the map
  /// [height, width] of that view in [0, 1] on the host: large where the other views attend. It ranks pixels and is no
  /// probability. Views may differ in size in the mode `official`; otherwise all that are asked for must have one size,
  /// and the reference cannot be one of them. Throws ShapeError, Interrupted.
  virtual std::vector<Buffer<float>> Confidence(const std::vector<Image8>& views, const std::vector<size_t>& asked) = 0;
};

/// Pixel at which one image shows a point.
struct CloudSight {
  int view = 0;           ///< index of the image
  Eigen::Vector2d pixel;  ///< from the image's top-left corner
};

struct CloudPoint {
  Eigen::Vector3d xyz;
  std::array<uint8_t, 3> rgb{};
  std::vector<CloudSight> sights;  ///< at least two, by view
};

/// Cameras and a point cloud, in a world whose scale and orientation are VGGT's own.
struct PoseEstimate {
  std::vector<Camera> cameras;  ///< pinhole, in the pixels of each image
  std::vector<CloudPoint> cloud;
};

struct PoseRequest {
  std::filesystem::path weights;
  std::string network = "VGGT";  ///< its name in messages
  std::vector<Image8> images;
  std::vector<std::string> names;  ///< names of the images, for errors
  Device device;
  int64_t free_bytes = 0;  ///< free memory of the device; 0 = unknown
};

/// Weight files of Stable Virtual Camera.
struct SevaFiles {
  std::vector<std::filesystem::path> unet;
  std::filesystem::path vae, clip;
};

struct ViewGeneratorRequest {
  SevaFiles files;
  SevaOptions options;
  Device device;
  int64_t free_bytes = 0;  ///< free memory of the device before the networks are loaded; 0 = unknown
};

struct ViewRequest {
  const std::vector<LoadedView>* views = nullptr;  ///< conditioning views, at least one
  std::vector<Camera> targets;
  std::filesystem::path workspace = {};  ///< finished chunks are kept here; empty = nowhere
  std::string key = {};  ///< identifies views, targets and weights: chunks stored under another key are not reused
};

/// Stable Virtual Camera: images and target cameras to new views.
class ViewGenerator {
 public:
  virtual ~ViewGenerator() = default;
  /// For each target options.candidates images of its camera's size, RGB in [0, 1]. The whole
  /// frame of the camera is generated, so its pose and intrinsics are exact. The images depend on the seed, not on
  /// interruptions; only decoding in tiles, where memory is short, changes them, with a warning. Polls for interrupts
  /// between steps; reports StepDone{"propose"} after each. Throws RunError when memory does not suffice (before the
  /// first step), UsageError for options that do not fit the views, InputError for views of different working sizes,
  /// Interrupted.
  virtual std::vector<std::vector<ImageF>> Generate(const ViewRequest& request, const Listener& listener) const = 0;
};

/// Makes networks from files. Every function throws InputError, one line that lists all that does not fit, and asks the
/// thread pool how many threads to use. The device must be one that this library can use: see has_cuda.
class Networks {
 public:
  virtual ~Networks() = default;
  /// True when its libtorch computes on GPUs; otherwise networks run on the CPU alone.
  virtual bool has_cuda() const = 0;
  virtual std::unique_ptr<DepthNetwork> LoadDepth(const std::filesystem::path& weights, Device device) const = 0;
  virtual std::unique_ptr<KeypointNetwork> LoadKeypoints(const std::filesystem::path& weights, Device device) const = 0;
  /// cache_bytes: for targets' features (PerceptualNetwork::Loss); what does not fit is computed each time.
  virtual std::unique_ptr<PerceptualNetwork> LoadPerceptual(const std::vector<std::filesystem::path>& weights,
                                                            Device device, int64_t cache_bytes) const = 0;
  /// Throws InputError for layers that the network does not have, too.
  virtual std::unique_ptr<AttentionNetwork> OpenAttention(const std::filesystem::path& weights,
                                                          const AttentionOptions& options, Device device) const = 0;
  /// Runs VGGT in one pass over all images. A Note says how much memory that needs. Throws RunError when that is more
  /// than there is, InputError naming the images that get no camera.
  virtual PoseEstimate EstimatePoses(const PoseRequest& request, const Listener& listener) const = 0;
  virtual std::unique_ptr<ViewGenerator> LoadViewGenerator(const ViewGeneratorRequest& request) const = 0;
  /// Throws the RunError of ViewGenerator::Generate where request.free_bytes do not suffice for images of this size,
  /// before anything is loaded.
  virtual void RequireMemoryToGenerate(const ViewGeneratorRequest& request, seva::Size photo) const = 0;
};

}  // namespace oraclegs
