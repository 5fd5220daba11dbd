#include "oraclegs/scene/masks.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/text.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/image/exif.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/scene/fit_cameras.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

using Histogram = std::array<int64_t, 256>;

constexpr int kHalfWhite = 128;           // a mask with brighter pixels is one of black and white
constexpr double kMaskLike = .98;         // share of pixels at either end
constexpr double kAlmostAll = .98;        // of a border or middle
constexpr double kMinKeptOfAll = .005;    // less is no photo of an object
constexpr double kMinInvertedShare = .8;  // of the masks
constexpr size_t kMinMasksToJudge = 2;

/// The levels of a gray PNG of 16 bits, reduced to 8 only where they need the 16.
Image8 ReadGray16(const fs::path& path) {
  const Image16 gray = ReadPng16(path);
  const bool small = std::all_of(gray.values.begin(), gray.values.end(), [](uint16_t v) { return v <= 255; });
  Image8 levels{gray.width, gray.height, 1, std::vector<uint8_t>(gray.values.size())};
  for (size_t i = 0; i < gray.values.size(); ++i) {
    levels.data[i] = static_cast<uint8_t>(small ? gray.values[i] : gray.values[i] >> 8);
  }
  return levels;
}

/// The brightest of the color channels: labels may be colored.
uint8_t LevelAt(const Image8& image, size_t pixel) {
  const uint8_t* at = &image.data[pixel * static_cast<size_t>(image.channels)];
  return image.channels < 3 ? at[0] : std::max({at[0], at[1], at[2]});
}

/// How an RGBA file says what to keep: by alpha where its colors are one, or those of a photo; else, and where alpha
/// says nothing, by both.
enum class MaskAlpha { kAlone, kBoth };
MaskAlpha UseOfAlpha(const Image8& image) {
  Histogram levels{};
  const size_t pixels = image.data.size() / 4;
  bool opaque = true;
  for (size_t i = 0; i < pixels; ++i) {
    ++levels[LevelAt(image, i)];
    opaque &= image.data[4 * i + 3] == 255;
  }
  if (opaque) return MaskAlpha::kBoth;
  const auto used = std::count_if(levels.begin(), levels.end(), [](int64_t n) { return n > 0; });
  const bool mask_like = static_cast<double>(levels.front() + levels.back()) >= kMaskLike * static_cast<double>(pixels);
  return used <= 1 || !mask_like ? MaskAlpha::kAlone : MaskAlpha::kBoth;
}

/// A mask file as one channel, not yet scaled to black and white.
Image8 ReadLevels(const fs::path& path, Orientation orientation) {
  if (PngGrayBits(ReadHead(path, kPngHeaderBytes)) == 16) return ReadGray16(path);
  const Image8 image = ReadImage(path, orientation);
  Image8 levels{image.width, image.height, 1, {}};
  levels.data.resize(image.data.size() / static_cast<size_t>(image.channels));
  const bool has_alpha = image.channels == 4;
  const MaskAlpha use = has_alpha ? UseOfAlpha(image) : MaskAlpha::kBoth;
  for (size_t i = 0; i < levels.data.size(); ++i) {
    const uint8_t alpha = has_alpha ? image.data[4 * i + 3] : 255;
    levels.data[i] = use == MaskAlpha::kAlone ? alpha : std::min(LevelAt(image, i), alpha);
  }
  return levels;
}

int Threshold(int white) { return (white + 1) / 2; }

/// The orientation that turns an upright image back into one that `orientation` makes upright.
int InverseOrientation(int orientation) { return orientation == 6 ? 8 : orientation == 8 ? 6 : orientation; }

/// The EXIF orientation of a file; that of a PNG, which no reader here applies, is 1.
int StoredOrientation(const fs::path& path) {
  const ImageInfo info = ReadImageInfo(path);
  return info.extension == ".png" ? 1 : info.exif.orientation;
}

[[noreturn]] void ThrowOtherSize(const SceneView& view, const Image8& mask, int width, int height) {
  throw InputError("{}: is {} x {}, but its photo {} is {} x {}; make them the same size", view.mask_path.string(),
                   mask.width, mask.height, view.name, width, height);
}

/// Facts that count of one mask file.
struct MaskFacts {
  int width = 0, height = 0;
  Histogram all{}, border{}, middle{};

  int Brightest() const {
    int level = 255;
    while (level > 0 && all[static_cast<size_t>(level)] == 0) --level;
    return level;
  }
};

/// Share of the pixels from the threshold on.
double KeptShare(const Histogram& levels, int threshold) {
  int64_t kept = 0, total = 0;
  for (size_t level = 0; level < levels.size(); ++level) {
    total += levels[level];
    if (static_cast<int>(level) >= threshold) kept += levels[level];
  }
  return total == 0 ? 0 : static_cast<double>(kept) / static_cast<double>(total);
}

MaskFacts LookAt(const fs::path& path) {
  const Image8 levels = ReadLevels(path, Orientation::kUpright);
  MaskFacts facts{levels.width, levels.height};
  for (int y = 0; y < levels.height; ++y) {
    for (int x = 0; x < levels.width; ++x) {
      const uint8_t level =
          levels.data[static_cast<size_t>(y) * static_cast<size_t>(levels.width) + static_cast<size_t>(x)];
      const bool at_border = x == 0 || y == 0 || x == levels.width - 1 || y == levels.height - 1;
      const bool in_middle =
          std::abs(2 * x - levels.width) * 5 < levels.width && std::abs(2 * y - levels.height) * 5 < levels.height;
      ++facts.all[level];
      facts.border[level] += at_border;
      facts.middle[level] += in_middle;
    }
  }
  return facts;
}

using FactsOfFiles = std::map<fs::path, MaskFacts>;

FactsOfFiles LookAtAll(const Scene& scene) {
  FactsOfFiles facts;
  for (const SceneView& view : scene.views) {
    if (!view.mask_path.empty()) facts.emplace(view.mask_path, MaskFacts());
  }
  std::vector<FactsOfFiles::value_type*> files;
  for (auto& file : facts) files.push_back(&file);
  ParallelFor(static_cast<int64_t>(files.size()), [&](int64_t i) {
    auto& [path, of_file] = *files[static_cast<size_t>(i)];
    of_file = LookAt(path);
  });
  return facts;
}

/// The value of white in all of these masks. Throws InputError when their values do not tell.
int FindWhite(const FactsOfFiles& facts, const Listener& listener) {
  Histogram all{};
  int white = 0;
  const fs::path* brightest = nullptr;
  for (const auto& [path, of_file] : facts) {
    for (size_t level = 0; level < all.size(); ++level) all[level] += of_file.all[level];
    if (of_file.Brightest() <= white) continue;
    white = of_file.Brightest();
    brightest = &path;
  }
  if (!brightest || white >= kHalfWhite) return 255;
  std::vector<std::string> values;
  for (size_t level = 0; level < all.size(); ++level) {
    if (all[level] > 0) values.push_back(std::to_string(level));
  }
  if (values.size() > 2) {
    throw InputError(
        "{}: this mask and the others have the values {} of 255, which do not say what is used; write white (255) "
        "where "
        "the photo is used and black (0) elsewhere",
        brightest->string(), SomeNames(values));
  }
  listener(Note{fmt::format("{}: the masks have the values {}; {} is taken for white, which is used",
                            brightest->parent_path().string(), fmt::join(values, " and "), white)});
  return white;
}

void RequireWhitePixels(const FactsOfFiles& facts, int white) {
  for (const auto& [path, of_file] : facts) {
    if (KeptShare(of_file.all, Threshold(white)) > 0) continue;
    throw InputError(
        "{}: this mask ignores every pixel of its photo (its brightest value is {} of {}); make white what is to be "
        "used, or leave the photo out",
        path.string(), of_file.Brightest(), white);
  }
}

/// Throws for a mask of another aspect than its photo's; notes those of another size.
void CompareSizes(const Scene& scene, const FactsOfFiles& facts, const Listener& listener) {
  std::vector<std::string> scaled;
  for (const SceneView& view : scene.views) {
    const auto found = facts.find(view.mask_path);
    if (found == facts.end()) continue;
    const auto& [width, height] = std::pair(view.intrinsics.width, view.intrinsics.height);
    const MaskFacts& mask = found->second;
    if (mask.width == width && mask.height == height) continue;
    if (!HaveSameAspect(mask.width, mask.height, width, height)) ReadMask(view, width, height, Orientation::kUpright);
    const bool turned = mask.width == height && mask.height == width;
    if (!turned) scaled.push_back(view.name);
  }
  if (scaled.empty()) return;
  listener(Note{fmt::format("{}: the masks of {} have another size than the photos and are scaled to them",
                            scene.root.string(), SomeNames(scaled))});
}

void WarnOfPhotosWithout(const Scene& scene, const Listener& listener) {
  std::vector<std::string> without;
  for (const SceneView& view : scene.views) {
    if (view.mask_path.empty()) without.push_back(view.name);
  }
  if (without.empty()) return;
  listener(Warning{fmt::format("{}: {} of {} have no mask, so all of their pixels are used: {}", scene.root.string(),
                               without.size(), Counted(scene.views.size(), "photo"), SomeNames(without))});
}

/// An object stands in the middle of its photos; a mask that keeps the border alone is made for the opposite.
void WarnOfInverted(const Scene& scene, const FactsOfFiles& facts, int white, const Listener& listener) {
  if (facts.size() < kMinMasksToJudge) return;
  size_t inverted = 0;
  double kept = 0;
  for (const auto& [path, of_file] : facts) {
    const int threshold = Threshold(white);
    inverted +=
        KeptShare(of_file.border, threshold) >= kAlmostAll && KeptShare(of_file.middle, threshold) <= 1 - kAlmostAll;
    kept += KeptShare(of_file.all, threshold) / static_cast<double>(facts.size());
  }
  if (static_cast<double>(inverted) >= kMinInvertedShare * static_cast<double>(facts.size())) {
    listener(Warning{fmt::format(
        "{}: {} of {} ignore the middle of the photo and keep its border; are they inverted? White is used, black is "
        "ignored",
        scene.root.string(), inverted, Counted(facts.size(), "mask"))});
  } else if (kept < kMinKeptOfAll) {
    listener(
        Warning{fmt::format("{}: the masks keep {:.1g} % of the pixels; are they inverted? White is used, black is "
                            "ignored",
                            scene.root.string(), 100 * kept)});
  }
}

/// A photo that EXIF turns by 180 degrees or mirrors keeps its size, so that nothing shows how its mask was drawn.
void WarnOfTurnedPhotos(const Scene& scene, const Listener& listener) {
  std::vector<uint8_t> turned(scene.views.size(), 0);
  ParallelFor(static_cast<int64_t>(turned.size()), [&](int64_t i) {
    const SceneView& view = scene.views[static_cast<size_t>(i)];
    if (view.mask_path.empty()) return;
    const int of_photo = StoredOrientation(view.image_path);
    turned[static_cast<size_t>(i)] = of_photo >= 2 && of_photo <= 4 && StoredOrientation(view.mask_path) == 1;
  });
  std::vector<std::string> names;
  for (size_t i = 0; i < turned.size(); ++i) {
    if (turned[i]) names.push_back(scene.views[i].name);
  }
  if (names.empty()) return;
  listener(Warning{fmt::format(
      "{}: EXIF turns {} by 180 degrees or mirrors them, and says nothing of their masks, which "
      "are taken as drawn on the photos {}; if they were not, turn the masks",
      scene.root.string(), SomeNames(names), scene.format == SceneFormat::kColmap ? "as stored" : "upright")});
}

}  // namespace

Image8 ReadMask(const SceneView& view, int width, int height, Orientation orientation) {
  const bool upright = orientation == Orientation::kUpright;
  Image8 mask = ReadLevels(view.mask_path, orientation);  // a copy of the photo's tag turns both alike
  if (!HaveSameAspect(mask.width, mask.height, width, height)) {
    Image8 other = ReadLevels(view.mask_path, upright ? Orientation::kAsStored : Orientation::kUpright);
    if (HaveSameAspect(other.width, other.height, width, height)) {
      mask = std::move(other);
    } else {
      const int of_photo = StoredOrientation(view.image_path);
      if (!SwapsAxes(of_photo) || !HaveSameAspect(mask.height, mask.width, width, height)) {
        ThrowOtherSize(view, mask, width, height);
      }
      mask = ApplyOrientation(std::move(mask), upright ? of_photo : InverseOrientation(of_photo));
    }
  }
  for (uint8_t& level : mask.data) level = level >= Threshold(view.mask_white) ? 255 : 0;
  return mask;
}

void DropMasks(Scene* scene, const Listener& listener) {
  std::vector<std::string> names;
  for (SceneView& view : scene->views) {
    if (!view.mask_path.empty()) names.push_back(view.name);
    view.mask_path.clear();
  }
  if (names.empty()) return;
  listener(Note{fmt::format("{}: its masks of {} are not used: the command of --masks makes others",
                            scene->root.string(), SomeNames(names))});
}

void CheckMasks(Scene* scene, const Listener& listener) {
  const FactsOfFiles facts = LookAtAll(*scene);
  if (facts.empty()) return;
  CompareSizes(*scene, facts, listener);
  const int white = FindWhite(facts, listener);
  RequireWhitePixels(facts, white);
  WarnOfPhotosWithout(*scene, listener);
  WarnOfInverted(*scene, facts, white, listener);
  WarnOfTurnedPhotos(*scene, listener);
  for (SceneView& view : scene->views) view.mask_white = static_cast<uint8_t>(white);
}

}  // namespace oraclegs
