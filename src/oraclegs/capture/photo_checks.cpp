#include "oraclegs/capture/photo_checks.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <mutex>
#include <string_view>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/statistics.h"
#include "oraclegs/core/text.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/scene/photo_folder.h"

namespace oraclegs {
namespace {

constexpr int kCheckSide = 640;
constexpr int kSignatureSide = 24;
constexpr size_t kMetadataBytes = 256 * 1024;  // XMP stands near the start

// A share of the set's median: at a third, edges are some three pixels wide at the checked size where others' are one.
constexpr double kBlurredShare = .3;
constexpr double kBlurredSharpness = 2e-3;  // less detail than this has no photo in focus, whatever it shows
constexpr size_t kMinForMedian = 4;
constexpr int kBlack = 4, kWhite = 251;  // gray levels at and beyond which a pixel is one of them
constexpr double kPlainBorder = .9;      // of an image's border: an object stands before a plain background
constexpr double kMinPanorama = 2.5;     // width by height; film is up to 2.4
constexpr double kAlikeLevels = 1.2;     // mean difference of gray levels of two photos from one place

/// As phones' screens are: 16:9 to 22:9.
bool IsPhoneScreen(int width, int height) {
  const double aspect = static_cast<double>(std::max(width, height)) / std::min(width, height);
  return aspect > 1.7 && aspect < 2.45 && std::min(width, height) >= 640;
}

double Difference(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() != b.size() || a.empty()) return 255;
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += std::abs(a[i] - b[i]);
  return sum / static_cast<double>(a.size());
}

void AddBorder(const Image8& gray, PhotoSigns* signs) {
  int64_t pixels = 0, dark = 0, bright = 0;
  for (int y = 0; y < gray.height; ++y) {
    const bool is_end = y == 0 || y == gray.height - 1;
    for (int x = 0; x < gray.width; x += is_end || gray.width == 1 ? 1 : gray.width - 1) {
      const uint8_t level =
          gray.data[static_cast<size_t>(y) * static_cast<size_t>(gray.width) + static_cast<size_t>(x)];
      ++pixels, dark += level <= kBlack, bright += level >= kWhite;
    }
  }
  signs->dark_border = static_cast<double>(dark) / static_cast<double>(pixels);
  signs->bright_border = static_cast<double>(bright) / static_cast<double>(pixels);
}

/// PhotoSigns::circles: beyond them all is black, and near their ends it is not, as it is around an object before
/// black.
int ImageCircles(const Image8& gray) {
  constexpr int kNoLight = 16;
  constexpr double kBeyond = 1.04, kRingBegin = .7, kRingEnd = .85;  // of the radius
  for (const int circles : {1, 2}) {
    const double width = static_cast<double>(gray.width) / circles, radius = std::min<double>(width, gray.height) / 2;
    int64_t beyond = 0, black = 0, ring = 0, lit = 0;
    for (int y = 0; y < gray.height; ++y) {
      for (int x = 0; x < gray.width; ++x) {
        const double away = std::hypot(std::fmod(x + .5, width) - width / 2, y + .5 - gray.height / 2.) / radius;
        const uint8_t level =
            gray.data[static_cast<size_t>(y) * static_cast<size_t>(gray.width) + static_cast<size_t>(x)];
        if (away > kBeyond) ++beyond, black += level <= kNoLight;
        if (away > kRingBegin && away < kRingEnd) ++ring, lit += level > kNoLight;
      }
    }
    if (beyond > 0 && black >= .98 * static_cast<double>(beyond) && lit >= .6 * static_cast<double>(ring)) {
      return circles;
    }
  }
  return 0;
}

/// Whether all photos have this border.
bool AllHave(double PhotoSigns::*border, const std::vector<PhotoSigns>& signs) {
  return std::all_of(signs.begin(), signs.end(), [=](const PhotoSigns& s) { return s.*border >= kPlainBorder; });
}

/// Adds "NAMES: what" when there are names.
void Say(const std::vector<std::string>& names, const char* one, const char* many, std::vector<std::string>* out) {
  if (!names.empty()) out->push_back(fmt::format("{}: {}", SomeNames(names), names.size() == 1 ? one : many));
}

}  // namespace

std::vector<CheckedPhoto> PhotosToCheck(const Scene& scene) {
  std::vector<CheckedPhoto> photos;
  for (const std::vector<int>& photo : ByPhoto(scene, AllViews(scene))) {
    const SceneView& view = scene.views[static_cast<size_t>(photo.front())];
    if (view.sphere) {
      photos.push_back({view.sphere->name, view.sphere->image_path, true});
    } else {
      photos.push_back({view.name, view.image_path});
    }
  }
  return photos;
}

PhotoSigns ReadSigns(const std::filesystem::path& path) {
  const std::string bytes = ReadFile(path, kMaxImageBytes);
  const Image8 gray = GrayThumbnail(bytes, path.string(), kCheckSide);
  PhotoSigns signs;
  const auto pixels = static_cast<double>(gray.data.size());
  double sum = 0, squares = 0, equal = 0;
  for (size_t i = 0; i < gray.data.size(); ++i) {
    const double level = gray.data[i];
    sum += level;
    squares += level * level;
    signs.dark += level <= kBlack;
    signs.bright += level >= kWhite;
    equal += i > 0 && gray.data[i] == gray.data[i - 1];
  }
  signs.mean = sum / pixels;
  signs.dark /= pixels;
  signs.bright /= pixels;
  signs.flat = equal / pixels;
  AddBorder(gray, &signs);
  signs.sharpness = Sharpness(gray) / (squares / pixels - signs.mean * signs.mean + 25);
  const ImageF small = ResizeArea(ToFloat(gray), kSignatureSide, kSignatureSide);
  for (const float value : small.data) signs.signature.push_back(255.0 * value);

  const std::string_view metadata = std::string_view(bytes).substr(0, kMetadataBytes);
  const ImageInfo info = ReadImageInfo(path);
  const double aspect = static_cast<double>(info.width) / info.height;
  signs.is_panorama = aspect >= kMinPanorama || ReadProjection(metadata) != Projection::kPlain;
  signs.circles = ImageCircles(gray);
  signs.may_be_sphere = !signs.is_panorama && signs.circles == 0 && aspect == 2 && !info.exif.HasCamera();
  signs.is_screenshot =
      IsPng(metadata) && !info.exif.HasCamera() && IsPhoneScreen(info.width, info.height) && signs.flat > .6;
  return signs;
}

std::vector<std::string> DescribeTrouble(const std::vector<std::string>& names, const std::vector<PhotoSigns>& signs) {
  std::vector<double> sharpness;
  for (const PhotoSigns& s : signs) sharpness.push_back(s.sharpness);
  const double usual = sharpness.size() >= kMinForMedian ? UpperMedian(sharpness) : 0;
  const bool before_black = AllHave(&PhotoSigns::dark_border, signs),
             before_white = AllHave(&PhotoSigns::bright_border, signs);
  std::vector<std::string> blurred, dark, bright, panoramas, spheres, circles, pairs, screenshots, alike;
  for (size_t i = 0; i < signs.size(); ++i) {
    const PhotoSigns& s = signs[i];
    if (s.is_screenshot) screenshots.push_back(names[i]);
    if (s.is_panorama && !s.is_screenshot) panoramas.push_back(names[i]);
    if (s.circles > 0) (s.circles == 1 ? circles : pairs).push_back(names[i]);
    if (s.may_be_sphere && !s.is_screenshot) spheres.push_back(names[i]);
    const bool is_dark = !before_black && (s.mean < 20 || s.dark > .7);
    const bool is_bright = !before_white && (s.mean > 240 || s.bright > .6);
    if (is_dark) dark.push_back(names[i]);
    if (is_bright && !s.is_screenshot) bright.push_back(names[i]);
    const bool is_blurred = s.sharpness < kBlurredSharpness || s.sharpness < kBlurredShare * usual;
    if (is_blurred && !is_dark && !is_bright && !s.is_screenshot) blurred.push_back(names[i]);
    for (size_t j = 0; j < i; ++j) {
      if (Difference(s.signature, signs[j].signature) >= kAlikeLevels) continue;
      alike.push_back(names[j] + " and " + names[i]);
      break;
    }
  }
  std::vector<std::string> out;
  Say(blurred, "is blurred; take it again with a steady hand or more light, or leave it out",
      "are blurred; take them again with a steady hand or more light, or leave them out", &out);
  Say(dark, "is almost black; take it again with a longer exposure",
      "are almost black; take them again with more light", &out);
  Say(bright, "is mostly white; take it again with a shorter exposure",
      "are mostly white; take them again with a shorter exposure", &out);
  Say(alike, "show the same from the same place; one of them helps little, take photos from different places",
      "show the same from the same place; copies help little, take photos from different places", &out);
  Say(panoramas, "is a panorama but no whole sphere, which no camera model here fits; take plain photos instead",
      "are panoramas but no whole spheres, which no camera model here fits; take plain photos instead", &out);
  Say(spheres, "may be a spherical photo, for it is twice as wide as high; if so, add --set spheres=all",
      "may be spherical photos, for they are twice as wide as high; if so, add --set spheres=all", &out);
  Say(circles,
      "is the image circle of a fisheye lens, whose camera is not found here; give it with its pose (OPENCV_FISHEYE in "
      "transforms.json or a COLMAP model), or let the camera's program make a 360-degree photo",
      "are image circles of a fisheye lens, whose camera is not found here; give it with their poses (OPENCV_FISHEYE "
      "in "
      "transforms.json or a COLMAP model), or let the camera's program make 360-degree photos",
      &out);
  Say(pairs,
      "is two image circles of fisheye lenses; let the camera's program stitch them to a 360-degree photo "
      "(equirectangular)",
      "are two image circles of fisheye lenses each; let the camera's program stitch them to 360-degree photos "
      "(equirectangular)",
      &out);
  Say(screenshots, "looks like a screenshot; give the photo itself, or leave it out",
      "look like screenshots; give the photos themselves, or leave them out", &out);
  return out;
}

PhotoTrouble CheckPhotos(const std::vector<CheckedPhoto>& photos, const Listener& listener) {
  std::vector<PhotoSigns> signs(photos.size());
  std::vector<std::string> damage(photos.size());
  std::mutex mutex;
  int64_t done = 0;
  const auto total = static_cast<int64_t>(photos.size());
  ParallelFor(total, [&](int64_t i) {
    ThrowIfInterrupted();
    try {
      PhotoSigns& of_photo = signs[static_cast<size_t>(i)];
      of_photo = ReadSigns(photos[static_cast<size_t>(i)].path);
      if (photos[static_cast<size_t>(i)].is_sphere) of_photo.is_panorama = of_photo.may_be_sphere = false;
    } catch (const InputError& error) {
      damage[static_cast<size_t>(i)] = error.what();
    }
    const std::lock_guard lock(mutex);
    listener(StepDone{"check", ++done, total, "photos", ""});
  });
  PhotoTrouble trouble;
  std::vector<std::string> names;
  std::vector<PhotoSigns> readable;
  for (size_t i = 0; i < photos.size(); ++i) {
    if (damage[i].empty()) {
      names.push_back(OneLine(photos[i].name));
      readable.push_back(std::move(signs[i]));
    } else {
      trouble.unreadable.push_back(i);
      trouble.warnings.push_back(damage[i] + "; it is left out");
    }
  }
  if (!trouble.unreadable.empty() && readable.size() < kMinGoodPhotos) {
    throw InputError("{}", damage[trouble.unreadable.front()]);
  }
  for (std::string& text : DescribeTrouble(names, readable)) trouble.warnings.push_back(std::move(text));
  return trouble;
}

bool AreOnWhite(const std::vector<std::filesystem::path>& photos) {
  if (photos.empty()) return false;
  try {
    for (const size_t i : {size_t{0}, photos.size() / 2, photos.size() - 1}) {
      if (ReadImageHeader(photos[i]).may_be_transparent) return false;
      const PhotoSigns signs = ReadSigns(photos[i]);
      if (signs.bright_border < kPlainBorder || signs.bright == 1) return false;
    }
  } catch (const InputError&) {  // CheckPhotos names it
    return false;
  }
  return true;
}

double Sharpness(const Image8& gray) {
  if (gray.width < 3 || gray.height < 3) return 0;
  const auto width = static_cast<size_t>(gray.width);
  double sum = 0, squares = 0;
  for (size_t y = 1; y + 1 < static_cast<size_t>(gray.height); ++y) {
    const uint8_t* row = gray.data.data() + y * width;
    for (size_t x = 1; x + 1 < width; ++x) {
      const uint8_t* at = row + x;
      const double laplacian = at[-1] + at[1] + *(at - width) + at[width] - 4.0 * at[0];
      sum += laplacian;
      squares += laplacian * laplacian;
    }
  }
  const double count = static_cast<double>((width - 2) * static_cast<size_t>(gray.height - 2));
  return squares / count - (sum / count) * (sum / count);
}

}  // namespace oraclegs
