#include "oraclegs/scene/loaded_view.h"

#include <algorithm>
#include <mutex>
#include <optional>
#include <system_error>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/camera/undistort.h"
#include "oraclegs/scene/scene_validation.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr uint8_t kMaskThreshold = 128;
constexpr float kCoverage = 0.5f;                   // of a working pixel's area that must count for it to count
constexpr int64_t kBytesPerPixel = 44;              // one photograph at full size: 8-bit, float, undistorted
constexpr int64_t kBytesAtOnce = int64_t{4} << 30;  // for all photographs in work, unless one alone needs more
constexpr int kKeep = 3;   // the channel beside RGB that says what counts, 0 or 1 before filtering
constexpr int kAlpha = 4;  // the channel beside these of a picture whose background is known to be nothing
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

/// A photograph and the lens it fits.
struct Source {
  Image8 image;
  Intrinsics lens;
};

Source ReadSource(const SceneView& view, int downscale) {
  const fs::path file = ImageFile(view, downscale);
  const bool is_full = file == view.image_path;
  Intrinsics lens =
      is_full ? view.lens
              : Resized(view.lens, WorkingSize(view.lens.width, downscale), WorkingSize(view.lens.height, downscale));
  if (const auto orientation = FittingOrientation(view, file, lens.width, lens.height)) {
    return {ReadImage(file, *orientation), std::move(lens)};
  }
  int width = 0, height = 0;
  ReadImageSize(file, &width, &height);
  throw InputError("{}: is {} x {}, but its camera was made for {} x {}; use the photographs the poses were made from",
                   file.string(), width, height, lens.width, lens.height);
}

float* Keep(size_t pixel, ImageF* image) { return &image->data[static_cast<size_t>(image->channels) * pixel + kKeep]; }

/// RGB on the background; of more channels the fourth is ones and the fifth alpha.
ImageF Composite(const Image8& image, const std::array<float, 3>& background, size_t out_channels) {
  const size_t in_channels = static_cast<size_t>(image.channels);
  const size_t pixels = image.data.size() / in_channels;
  ImageF result{image.width, image.height, static_cast<int>(out_channels),
                std::vector<float>(pixels * out_channels, 1)};
  const uint8_t* in = image.data.data();
  float* out = result.data.data();
  for (size_t i = 0; i < pixels; ++i, in += in_channels, out += out_channels) {
    const float alpha = in_channels == 4 ? static_cast<float>(in[3]) / 255 : 1.f;
    for (size_t c = 0; c < 3; ++c) out[c] = alpha * (static_cast<float>(in[c]) / 255) + (1 - alpha) * background[c];
    if (out_channels > kAlpha) out[kAlpha] = alpha;
  }
  return result;
}

void ExcludeTransparent(const Image8& image, ImageF* composite) {
  for (size_t i = 0; i < image.data.size() / 4; ++i) {
    if (image.data[4 * i + 3] < kMaskThreshold) *Keep(i, composite) = 0;
  }
}

/// Which pixels the view's mask file keeps, one channel of the size of `lens`.
ImageF ReadMask(const SceneView& view, const Intrinsics& lens) {
  const Image8 mask = ReadImage(view.mask_path);
  const bool is_full = mask.width == view.lens.width && mask.height == view.lens.height;
  if (!is_full && (mask.width != lens.width || mask.height != lens.height)) {
    throw InputError("{}: is {} x {}, but its photograph {} is {} x {}; make them the same size",
                     view.mask_path.string(), mask.width, mask.height, view.name, view.lens.width, view.lens.height);
  }
  const size_t channels = static_cast<size_t>(mask.channels);
  ImageF keep{mask.width, mask.height, 1, std::vector<float>(mask.data.size() / channels)};
  for (size_t i = 0; i < keep.data.size(); ++i) keep.data[i] = mask.data[i * channels] < kMaskThreshold ? 0.f : 1.f;
  return ResizeArea(keep, lens.width, lens.height);
}

/// Multiplies the keep channel by other pictures of what counts.
template <class Values>
void Exclude(const Values& keep, ImageF* image) {
  for (size_t i = 0; i < keep.size(); ++i) *Keep(i, image) *= static_cast<float>(keep[i]);
}

/// The photograph as its lens took it, composited; 4 channels when some pixels may not count, 5 when alpha is known.
ImageF ComposeSource(const Scene& scene, const SceneView& view, const Source& source, const ImageOptions& options) {
  const bool has_alpha = source.image.channels == 4, is_rendered = scene.format == SceneFormat::kBlender;
  const bool alpha_masks = has_alpha && !is_rendered;
  const bool with_keep = alpha_masks || !view.mask_path.empty() || !view.lens.IsPinhole();
  const size_t channels = has_alpha && is_rendered ? 5 : with_keep ? 4 : 3;
  ImageF image = Composite(source.image, BackgroundColor(options.background), channels);
  if (alpha_masks) ExcludeTransparent(source.image, &image);
  if (!view.mask_path.empty()) Exclude(ReadMask(view, source.lens).data, &image);
  return image;
}

/// Splits off the channels beside RGB.
void Store(ImageF image, LoadedView* photo) {
  if (image.channels == 3) {
    photo->rgb = std::move(image);
    return;
  }
  const size_t channels = static_cast<size_t>(image.channels), pixels = image.data.size() / channels;
  photo->rgb = {image.width, image.height, 3, std::vector<float>(pixels * 3)};
  photo->mask.resize(pixels);
  if (channels > kAlpha) photo->alpha.resize(pixels);
  for (size_t i = 0; i < pixels; ++i) {
    const float* pixel = image.data.data() + channels * i;
    std::copy_n(pixel, 3, photo->rgb.data.data() + 3 * i);
    photo->mask[i] = pixel[kKeep] >= kCoverage;
    if (channels > kAlpha) photo->alpha[i] = std::clamp(pixel[kAlpha], 0.f, 1.f);  // filters round
  }
  if (std::find(photo->mask.begin(), photo->mask.end(), 0) == photo->mask.end()) photo->mask.clear();
}

LoadedView LoadPhoto(const Scene& scene, const SceneView& view, const ImageOptions& options) {
  LoadedView photo{view.name, WorkingCamera(view, options), {}, {}, {}};
  Source source = ReadSource(view, options.downscale);
  ImageF image = ComposeSource(scene, view, source, options);
  source.image = {};  // the 8-bit picture is not needed beside the float ones
  if (!source.lens.IsPinhole()) {
    // The camera comes from the full size also when a downscaled file is read, so that both give the same one.
    const Camera target = Resized(UndistortedCamera(view.lens), source.lens.width, source.lens.height);
    UndistortedImage undistorted = Undistort(image, source.lens, target);
    image = std::move(undistorted.image);
    Exclude(undistorted.valid, &image);
  }
  if (image.width != photo.camera.width || image.height != photo.camera.height) {
    image = ResizeArea(image, photo.camera.width, photo.camera.height);
  }
  Store(std::move(image), &photo);
  return photo;
}

/// How many photographs may be in work at once.
int64_t PhotosAtOnce(const Scene& scene, const std::vector<int>& views) {
  int64_t largest = 1;
  for (const int i : views) {
    const Intrinsics& lens = scene.views[static_cast<size_t>(i)].lens;
    largest = std::max(largest, int64_t{lens.width} * lens.height);
  }
  return std::max<int64_t>(1, kBytesAtOnce / (largest * kBytesPerPixel));
}

bool ExcludesAll(const LoadedView& photo) {
  return !photo.mask.empty() && std::find(photo.mask.begin(), photo.mask.end(), 1) == photo.mask.end();
}

}  // namespace

std::array<float, 3> BackgroundColor(const std::string& name) {
  if (name == "black") return {0, 0, 0};
  if (name == "white") return {1, 1, 1};
  if (name == "grey") return {0.5f, 0.5f, 0.5f};
  throw UsageError("--background is '{}', must be one of: black, white, grey", name);
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

int WorkingSize(int size, int downscale) { return std::max(1, (2 * size + downscale) / (2 * downscale)); }

fs::path ImageFile(const SceneView& view, int downscale) {
  const fs::path small = downscale == 1 ? fs::path() : DownscaledFile(view.image_path, downscale);
  const int width = WorkingSize(view.lens.width, downscale), height = WorkingSize(view.lens.height, downscale);
  return !small.empty() && FittingOrientation(view, small, width, height) ? small : view.image_path;
}

Camera WorkingCamera(const SceneView& view, const ImageOptions& options) {
  Camera camera = UndistortedCamera(view.lens);
  camera.cam_from_world = view.cam_from_world.value();
  return Resized(camera, WorkingSize(camera.width, options.downscale), WorkingSize(camera.height, options.downscale));
}

std::vector<LoadedView> LoadViews(const Scene& scene, const std::vector<int>& views, const ImageOptions& options,
                              const Listener& listener) {
  std::vector<LoadedView> photos(views.size());
  std::mutex mutex;
  int64_t done = 0;
  const auto total = static_cast<int64_t>(views.size());
  const auto load = [&](int64_t i) {
    ThrowIfInterrupted();
    const auto index = static_cast<size_t>(i);
    photos[index] = LoadPhoto(scene, scene.views[static_cast<size_t>(views[index])], options);
    const std::lock_guard lock(mutex);
    listener(StepDone{"load", ++done, total, "photographs", ""});
  };
  const int64_t at_once = PhotosAtOnce(scene, views);
  for (int64_t begin = 0; begin < total; begin += at_once) {
    ParallelFor(std::min(at_once, total - begin), [&](int64_t i) { load(begin + i); });
  }
  std::vector<std::string> excluded;
  for (const LoadedView& photo : photos) {
    if (ExcludesAll(photo)) excluded.push_back(photo.name);
  }
  if (!excluded.empty()) {
    listener(Warning{fmt::format("no pixel of these photographs counts, their mask or alpha channel excludes all: {}",
                                 SomeNames(excluded))});
  }
  return photos;
}

}  // namespace oraclegs
