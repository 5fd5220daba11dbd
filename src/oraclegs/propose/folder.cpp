#include "oraclegs/propose/folder.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "oraclegs/core/error.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/text.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/propose/folder_layout.h"
#include "oraclegs/propose/target_check.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {
namespace {

constexpr double kShapeTolerance = 0.01;
constexpr double kCropTolerance = 0.06;  // generators round sides to multiples of 64 and crop what is over
constexpr double kMapTolerance = 0.03;   // attention maps have whole patches of 14 pixels of 518
constexpr int kGrayTolerance = 8;        // of 255 between channels: what a JPEG does to gray

constexpr const char* kTestPose =
    "they have the pose of a test view, which must stay unseen; remove them from the folder";
constexpr const char* kShape =
    "their width to height differs by more than 1 % from their camera's; generate them in the camera's shape";
constexpr const char* kViewShape =
    "their width to height differs by more than 6 % from their view's; generate them in the view's shape";

bool SameShape(int width, int height, int other_width, int other_height, double tolerance = kShapeTolerance) {
  const double ratio = static_cast<double>(width) * other_height / (static_cast<double>(height) * other_width);
  return std::abs(ratio - 1) <= tolerance;
}

/// Camera of the part of a view that an image of another shape shows, at the view's resolution. Generators fit images
/// to their sizes by scaling the view until it covers the image and cropping the rest evenly.
Camera CenterCrop(const Camera& view, const Image8& image) {
  const double scale =
      std::max(static_cast<double>(image.width) / view.width, static_cast<double>(image.height) / view.height);
  const double width = image.width / scale, height = image.height / scale;
  Camera crop = view;
  crop.width = std::max(1, static_cast<int>(std::lround(width)));
  crop.height = std::max(1, static_cast<int>(std::lround(height)));
  const double across = crop.width / width, down = crop.height / height;
  crop.fx = view.fx * across, crop.cx = (view.cx - (view.width - width) / 2) * across;
  crop.fy = view.fy * down, crop.cy = (view.cy - (view.height - height) / 2) * down;
  return crop;
}

/// Camera of a file, scaled to the size that the run works at.
Camera AtWorkingSize(const Camera& camera, const FolderRequest& request) {
  if (SameShape(camera.width, camera.height, request.width, request.height)) {
    return Resized(camera, request.width, request.height);
  }
  const double pixels = static_cast<double>(request.width) * request.height;
  const double scale = std::min(1., std::sqrt(pixels / (static_cast<double>(camera.width) * camera.height)));
  return Resized(camera, std::max(1, static_cast<int>(std::lround(camera.width * scale))),
                 std::max(1, static_cast<int>(std::lround(camera.height * scale))));
}

ImageF Composited(const Image8& image, const std::array<float, 3>& background) {
  ImageF rgb{image.width, image.height, 3, {}};
  const auto channels = static_cast<size_t>(image.channels);
  rgb.data.resize(image.data.size() / channels * 3);
  for (size_t i = 0; i < image.data.size() / channels; ++i) {
    const float alpha = channels == 4 ? static_cast<float>(image.data[4 * i + 3]) / 255 : 1;
    for (size_t c = 0; c < 3; ++c) {
      rgb.data[3 * i + c] =
          alpha * static_cast<float>(image.data[channels * i + c]) / 255 + (1 - alpha) * background[c];
    }
  }
  return rgb;
}

bool IsGray(const Image8& image) {
  const auto channels = static_cast<size_t>(image.channels);
  for (size_t i = 0; i < image.data.size(); i += channels) {
    const uint8_t* p = image.data.data() + i;
    if (std::max({p[0], p[1], p[2]}) - std::min({p[0], p[1], p[2]}) > kGrayTolerance) return false;
  }
  return true;
}

/// Result of loading one image.
struct Loaded {
  std::optional<Proposal> proposal;
  bool cropped = false;  // it shows the middle of its view only
  std::vector<float> confidence;
  const char* skipped = nullptr;          // why there is no proposal
  const char* confidence_lost = nullptr;  // why a confidence file is not used
};

/// Largest centered part of `map` in the shape of `image`.
Image8 MiddleOf(const Image8& map, const Image8& image) {
  const double scale =
      std::max(static_cast<double>(image.width) / map.width, static_cast<double>(image.height) / map.height);
  const int width = std::clamp(static_cast<int>(std::lround(image.width / scale)), 1, map.width);
  const int height = std::clamp(static_cast<int>(std::lround(image.height / scale)), 1, map.height);
  Image8 middle{width, height, map.channels, {}};
  for (int64_t y = (map.height - height) / 2; middle.data.size() < size_t{1} * width * height * map.channels; ++y) {
    const auto row = map.data.begin() + (y * map.width + (map.width - width) / 2) * map.channels;
    middle.data.insert(middle.data.end(), row, row + int64_t{width} * map.channels);
  }
  return middle;
}

/// Loads the confidence of `image` into `loaded`. `whole`: camera of the view that the image may be the middle of.
void LoadConfidence(const std::filesystem::path& file, const Image8& image, const Camera& whole, Loaded* loaded) {
  const Camera& camera = loaded->proposal->camera;
  try {
    Image8 map = ReadImage(file);
    if (loaded->cropped && SameShape(map.width, map.height, whole.width, whole.height)) map = MiddleOf(map, image);
    if (!SameShape(map.width, map.height, image.width, image.height, kMapTolerance)) {
      loaded->confidence_lost = "of another shape than their images";
    } else if (!IsGray(map)) {
      loaded->confidence_lost = "in colors instead of gray";
    } else {
      const ImageF resized = ResizeArea(Composited(map, {}), camera.width, camera.height);
      for (size_t i = 0; i < resized.data.size(); i += 3) {
        loaded->confidence.push_back(std::clamp(resized.data[i], 0.f, 1.f));
      }
    }
  } catch (const InputError&) {
    loaded->confidence_lost = "not readable";
  }
}

Loaded Load(const FolderImage& image, const FolderRequest& request, bool named_like_view) {
  Loaded loaded;
  Image8 pixels;
  try {
    pixels = ReadImage(image.file);
  } catch (const InputError&) {
    loaded.skipped = kUnreadableImage;
    return loaded;
  }
  const Camera& whole = image.camera;
  loaded.cropped = !SameShape(pixels.width, pixels.height, whole.width, whole.height);
  const bool near = SameShape(pixels.width, pixels.height, whole.width, whole.height, kCropTolerance);
  if (loaded.cropped && !(named_like_view && near)) {
    loaded.skipped = named_like_view ? kViewShape : kShape;
    return loaded;
  }
  const Camera camera = loaded.cropped    ? CenterCrop(whole, pixels)
                        : named_like_view ? whole
                                          : AtWorkingSize(whole, request);
  loaded.proposal = Proposal{image.name, "folder", camera, {}};
  loaded.proposal->rgb = ResizeArea(Composited(pixels, request.background), camera.width, camera.height);
  if (!image.confidence.empty()) LoadConfidence(image.confidence, pixels, whole, &loaded);
  return loaded;
}

void WarnOfSkipped(const FolderContent& content, const Listener& listener) {
  for (const auto& [why, names] : content.skipped) {
    listener(Warning{fmt::format("{}: {} proposals are skipped ({}): {}", content.images_dir.string(), names.size(),
                                 SomeNames(names), why)});
  }
}

void WarnOfConfidence(const FolderContent& content, const SkippedImages& lost, const std::vector<std::string>& missing,
                      const Listener& listener) {
  const std::string dir = content.confidence_dir.string();
  for (const auto& [why, names] : lost) {
    listener(
        Warning{fmt::format("{}: {} confidence maps are {} and not used: {}; write them as 8-bit gray PNG of the "
                            "image's size",
                            dir, names.size(), why, SomeNames(names))});
  }
  if (missing.empty()) return;
  listener(
      Warning{fmt::format("{}: {} proposals have no confidence map there, so the oracle predicts it: {}; add "
                          "NAME.png for each to use your own",
                          dir, missing.size(), SomeNames(missing))});
}

}  // namespace

FolderProposals ReadProposalFolder(const std::filesystem::path& dir, const FolderRequest& request,
                                   const Listener& listener) {
  if (request.width < 1 || request.height < 1) {
    throw ShapeError("ReadProposalFolder: the working size is {} x {}", request.width, request.height);
  }
  FolderContent content = FindFolderImages(dir, request);
  const bool named_like_views = !IsFile(content.images_dir / "transforms.json");
  std::vector<Camera> test_cameras;
  for (const Target& target : request.test) test_cameras.push_back(target.camera);
  const PoseSet test(std::move(test_cameras), SamePlace(request.train));

  std::vector<Loaded> loaded(content.images.size());
  ParallelFor(static_cast<int64_t>(loaded.size()), [&](int64_t task) {
    const auto i = static_cast<size_t>(task);
    if (test.Has(content.images[i].camera)) {
      loaded[i].skipped = kTestPose;
    } else {
      loaded[i] = Load(content.images[i], request, named_like_views);
    }
  });
  FolderProposals result;
  SkippedImages lost;
  std::vector<std::string> missing, cropped;
  for (size_t i = 0; i < loaded.size(); ++i) {
    const FolderImage& image = content.images[i];
    if (loaded[i].skipped != nullptr) {
      content.skipped[loaded[i].skipped].push_back(image.shown);
      continue;
    }
    if (loaded[i].cropped) cropped.push_back(image.shown);
    result.proposals.push_back(std::move(*loaded[i].proposal));
    result.confidence.push_back(std::move(loaded[i].confidence));
    if (loaded[i].confidence_lost != nullptr) lost[loaded[i].confidence_lost].push_back(image.shown);
    if (!content.confidence_dir.empty() && image.confidence.empty()) missing.push_back(image.shown);
  }
  WarnOfSkipped(content, listener);
  if (!cropped.empty()) {
    listener(
        Note{fmt::format("{}: {} proposals have not quite the shape of their views and are taken for their middle: "
                         "{}",
                         content.images_dir.string(), cropped.size(), SomeNames(cropped))});
  }
  if (result.proposals.empty()) {
    listener(Warning{
        fmt::format("{}: none of its proposals can be used; going on without them", content.images_dir.string())});
  }
  WarnOfConfidence(content, lost, missing, listener);
  return result;
}

}  // namespace oraclegs
