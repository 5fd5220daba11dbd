#include "oraclegs/scene/loaded_view.h"

#include <algorithm>
#include <mutex>
#include <optional>
#include <system_error>
#include <utility>

#include "oraclegs/camera/undistort.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/text.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/scene/masks.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr float kMinCoverage = 0.5f;                   // of a working pixel's area that must be used for it to be used
constexpr int64_t kBytesPerPixel = 44;                 // one image at full size: 8-bit, float, undistorted
constexpr int64_t kMaxBytesAtOnce = int64_t{4} << 30;  // for all images in work, unless one alone needs more
constexpr int kKeepChannel = 3;                        // beside RGB: 1 = used, 0 = excluded (before filtering)
constexpr int kAlphaChannel = 4;  // beside these, of an image whose background is known to be nothing
constexpr const char* kImageFolder = "images";

/// The file of an images_N folder that stands for `path` at the given downscale; empty when there is none.
fs::path DownscaledFile(const fs::path& path, int downscale) {
  fs::path inside = path.filename();
  for (fs::path folder = path.parent_path(); folder.has_relative_path(); folder = folder.parent_path()) {
    if (folder.filename() == kImageFolder) {
      const fs::path file = folder.parent_path() / fmt::format("{}_{}", kImageFolder, downscale) / inside;
      std::error_code error;
      return fs::is_regular_file(file, error) ? file : fs::path();
    }
    inside = folder.filename() / inside;
  }
  return {};
}

/// An image and the intrinsics it fits.
struct Source {
  Image8 image;
  Intrinsics intrinsics;
  Orientation orientation = Orientation::kUpright;  ///< in which the image was read
};

/// Pixels that an image of the dataset's folder images_N must have.
PixelSize SizeOfSmallerCopy(const SceneView& view, int downscale) {
  return WorkingSize({view.intrinsics.width, view.intrinsics.height}, {.downscale = downscale});
}

Source ReadSource(const SceneView& view, const ImageOptions& options) {
  const fs::path file = ImageFile(view, options);
  const bool is_full = file == view.image_path;
  const PixelSize copy = SizeOfSmallerCopy(view, options.downscale);
  Intrinsics intrinsics = is_full ? view.intrinsics : Resized(view.intrinsics, copy.width, copy.height);
  if (const auto orientation = FittingOrientation(view, file, intrinsics.width, intrinsics.height)) {
    return {ReadImage(file, *orientation), std::move(intrinsics), *orientation};
  }
  int width = 0, height = 0;
  ReadImageSize(file, &width, &height);
  throw InputError("{}: is {} x {}, but its camera was made for {} x {}; use the photos the poses were made from",
                   file.string(), width, height, intrinsics.width, intrinsics.height);
}

float* Keep(size_t pixel, ImageF* image) {
  return &image->data[static_cast<size_t>(image->channels) * pixel + kKeepChannel];
}

/// The use of alpha for the color of a transparent pixel.
enum class AlphaUse {
  kOnBackground,   ///< it is mixed with the background
  kPremultiplied,  ///< it is multiplied by alpha, so that filters weigh it, until TakeStraightColors divides
};

/// RGB; of more channels the fourth is ones and the fifth alpha.
ImageF Composite(const Image8& image, const std::array<float, 3>& background, AlphaUse use, size_t out_channels) {
  const size_t in_channels = static_cast<size_t>(image.channels);
  const size_t pixels = image.data.size() / in_channels;
  ImageF result{image.width, image.height, static_cast<int>(out_channels),
                std::vector<float>(pixels * out_channels, 1)};
  const uint8_t* in = image.data.data();
  float* out = result.data.data();
  for (size_t i = 0; i < pixels; ++i, in += in_channels, out += out_channels) {
    const float alpha = in_channels == 4 ? static_cast<float>(in[3]) / 255 : 1.f;
    const float behind = use == AlphaUse::kOnBackground ? 1 - alpha : 0.f;
    for (size_t c = 0; c < 3; ++c) out[c] = alpha * (static_cast<float>(in[c]) / 255) + behind * background[c];
    if (out_channels > kAlphaChannel) out[kAlphaChannel] = alpha;
  }
  return result;
}

/// Which pixels the view's mask file keeps, one channel of the size of the source.
ImageF KeptByMask(const SceneView& view, const Source& source) {
  const int width = source.image.width, height = source.image.height;
  return ResizeArea(ToFloat(ReadMask(view, width, height, source.orientation)), width, height);
}

/// Multiplies the keep channel by another mask.
template <class Values>
void Exclude(const Values& keep, ImageF* image) {
  for (size_t i = 0; i < keep.size(); ++i) *Keep(i, image) *= static_cast<float>(keep[i]);
}

/// True when the alpha channel of the scene's images says what belongs to a photo, and not what is behind the scene.
bool AlphaMasks(const Scene& scene) { return scene.format != SceneFormat::kBlender; }

/// The image as taken, composited; 4 channels when some pixels may be excluded, 5 when alpha is known.
ImageF ComposeSource(const Scene& scene, const SceneView& view, const Source& source, const ImageOptions& options) {
  const bool with_keep = !view.mask_path.empty() || !view.intrinsics.IsPinhole();
  const size_t channels = source.image.channels == 4 ? 5 : with_keep ? 4 : 3;
  const AlphaUse use = AlphaMasks(scene) ? AlphaUse::kPremultiplied : AlphaUse::kOnBackground;
  ImageF image = Composite(source.image, BackgroundColor(options.background), use, channels);
  if (channels == 5 && AlphaMasks(scene)) {
    for (size_t i = 0; i < image.data.size() / channels; ++i) *Keep(i, &image) = *(Keep(i, &image) + 1);
  }
  if (!view.mask_path.empty()) Exclude(KeptByMask(view, source).data, &image);
  return image;
}

/// From premultiplied colors and alpha to straight colors, and alpha as the weights of used pixels where it is partial.
/// Pixels that nothing covers have the color of the background.
void TakeStraightColors(const std::array<float, 3>& background, LoadedView* loaded) {
  constexpr float kMinAlpha = 1e-3f, kMaxAlpha = 1 - 1e-3f;  // filters round
  std::vector<float> weights = std::move(loaded->alpha);
  loaded->alpha.clear();
  bool partial = false;
  for (size_t i = 0; i < weights.size(); ++i) {
    float* color = loaded->rgb.data.data() + 3 * i;
    const float alpha = weights[i];
    for (size_t c = 0; c < 3; ++c) color[c] = alpha < kMinAlpha ? background[c] : std::min(color[c] / alpha, 1.f);
    if (loaded->mask[i] == 0) weights[i] = 0;
    partial |= weights[i] > 0 && weights[i] < kMaxAlpha;
  }
  if (partial) loaded->weights = std::move(weights);
}

/// Splits off the channels beside RGB.
void Store(ImageF image, LoadedView* loaded) {
  if (image.channels == 3) {
    loaded->rgb = std::move(image);
    return;
  }
  const size_t channels = static_cast<size_t>(image.channels), pixels = image.data.size() / channels;
  loaded->rgb = {image.width, image.height, 3, std::vector<float>(pixels * 3)};
  loaded->mask.resize(pixels);
  if (channels > kAlphaChannel) loaded->alpha.resize(pixels);
  for (size_t i = 0; i < pixels; ++i) {
    const float* pixel = image.data.data() + channels * i;
    std::copy_n(pixel, 3, loaded->rgb.data.data() + 3 * i);
    loaded->mask[i] = pixel[kKeepChannel] >= kMinCoverage;
    if (channels > kAlphaChannel) loaded->alpha[i] = std::clamp(pixel[kAlphaChannel], 0.f, 1.f);  // filters round
  }
}

LoadedView LoadView(const Scene& scene, const SceneView& view, const ImageOptions& options) {
  LoadedView loaded{view.name, WorkingCamera(view, options), {}, {}};
  Source source = ReadSource(view, options);
  ImageF image = ComposeSource(scene, view, source, options);
  source.image = {};  // the 8-bit image is not needed beside the float ones
  if (!source.intrinsics.IsPinhole()) {
    // The camera comes from the full size also when a downscaled file is read, so that both give the same one.
    const Camera target =
        Resized(UndistortedCamera(view.intrinsics), source.intrinsics.width, source.intrinsics.height);
    UndistortedImage undistorted = Undistort(image, source.intrinsics, target);
    image = std::move(undistorted.image);
    Exclude(undistorted.valid, &image);
  }
  if (image.width != loaded.camera.width || image.height != loaded.camera.height) {
    const bool is_premultiplied = image.channels > kAlphaChannel && AlphaMasks(scene);  // no color that bytes can hold
    const bool like_pillow = options.resize == ResizeFilter::kPillow && !is_premultiplied;
    image = (like_pillow ? ResizeRgbLikePillow : ResizeArea)(image, loaded.camera.width, loaded.camera.height);
  }
  Store(std::move(image), &loaded);
  if (AlphaMasks(scene) && !loaded.alpha.empty()) TakeStraightColors(BackgroundColor(options.background), &loaded);
  if (std::find(loaded.mask.begin(), loaded.mask.end(), 0) == loaded.mask.end()) loaded.mask.clear();
  return loaded;
}

/// How many views may be in work at once.
int64_t ViewsAtOnce(const Scene& scene, const std::vector<int>& views) {
  int64_t largest = 1;
  for (const int i : views) {
    const Intrinsics& intrinsics = scene.views[static_cast<size_t>(i)].intrinsics;
    largest = std::max(largest, int64_t{intrinsics.width} * intrinsics.height);
  }
  return std::max<int64_t>(1, kMaxBytesAtOnce / (largest * kBytesPerPixel));
}

bool ExcludesAll(const LoadedView& loaded) {
  return !loaded.mask.empty() && std::find(loaded.mask.begin(), loaded.mask.end(), 1) == loaded.mask.end();
}

}  // namespace

std::array<float, 3> BackgroundColor(Background background) {
  switch (background) {
    case Background::kWhite:
      return {1, 1, 1};
    case Background::kGray:
      return {0.5f, 0.5f, 0.5f};
    default:
      return {0, 0, 0};
  }
}

std::optional<Orientation> FittingOrientation(const SceneView& view, const fs::path& file, int width, int height) {
  std::array<Orientation, 2> ways{Orientation::kUpright, Orientation::kAsStored};
  if (view.as_stored) std::swap(ways[0], ways[1]);
  for (const Orientation way : ways) {
    int file_width = 0, file_height = 0;
    ReadImageSize(file, &file_width, &file_height, way);
    if (file_width == width && file_height == height) return way;
  }
  return std::nullopt;
}

PixelSize WorkingSize(PixelSize full, const ImageOptions& options) {
  const int downscale = options.downscale;
  const auto divided = [downscale](int side) { return std::max(1, (2 * side + downscale) / (2 * downscale)); };
  const PixelSize size{divided(full.width), divided(full.height)};
  const int longer = std::max(size.width, size.height), limit = options.max_size;
  if (limit == 0 || longer <= limit) return size;
  const auto reduced = [&](int side) {
    return std::max(1, static_cast<int>((int64_t{2} * side * limit + longer) / (2 * longer)));
  };
  return {reduced(size.width), reduced(size.height)};
}

fs::path ImageFile(const SceneView& view, const ImageOptions& options) {
  const int downscale = options.downscale;
  if (downscale == 1) return view.image_path;
  const fs::path small = DownscaledFile(view.image_path, downscale);
  const PixelSize size = SizeOfSmallerCopy(view, downscale);
  return !small.empty() && FittingOrientation(view, small, size.width, size.height) ? small : view.image_path;
}

Camera WorkingCamera(const SceneView& view, const ImageOptions& options) {
  Camera camera = UndistortedCamera(view.intrinsics);
  camera.cam_from_world = view.cam_from_world.value();
  const PixelSize size = WorkingSize({camera.width, camera.height}, options);
  return Resized(camera, size.width, size.height);
}

std::vector<Camera> WorkingCameras(const Scene& scene, const std::vector<int>& views, const ImageOptions& options) {
  std::vector<Camera> cameras;
  for (const int i : views) cameras.push_back(WorkingCamera(scene.views[static_cast<size_t>(i)], options));
  return cameras;
}

std::vector<LoadedView> LoadViews(const Scene& scene, const std::vector<int>& views, const ImageOptions& options,
                                  const Listener& listener) {
  std::vector<LoadedView> loaded(views.size());
  std::mutex mutex;
  int64_t done = 0;
  const auto total = static_cast<int64_t>(views.size());
  const auto load = [&](int64_t i) {
    ThrowIfInterrupted();
    const auto index = static_cast<size_t>(i);
    loaded[index] = LoadView(scene, scene.views[static_cast<size_t>(views[index])], options);
    const std::lock_guard lock(mutex);
    listener(StepDone{"load", ++done, total, "views", ""});
  };
  const int64_t at_once = ViewsAtOnce(scene, views);
  for (int64_t begin = 0; begin < total; begin += at_once) {
    ParallelFor(std::min(at_once, total - begin), [&](int64_t i) { load(begin + i); });
  }
  std::vector<std::string> excluded;
  for (const LoadedView& view : loaded) {
    if (ExcludesAll(view)) excluded.push_back(view.name);
  }
  if (!excluded.empty()) {
    listener(Warning{
        fmt::format("no pixel of these views is used, their mask or alpha channel excludes all: {}; correct the masks",
                    SomeNames(excluded))});
  }
  return loaded;
}

std::vector<Camera> CamerasOf(const std::vector<LoadedView>& views) {
  std::vector<Camera> cameras;
  for (const LoadedView& view : views) cameras.push_back(view.camera);
  return cameras;
}

}  // namespace oraclegs
