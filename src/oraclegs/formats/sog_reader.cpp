#include "oraclegs/formats/codecs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <system_error>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/formats/sog_layout.h"
#include "oraclegs/formats/webp.h"
#include "oraclegs/formats/zip_archive.h"

namespace oraclegs {
namespace {

constexpr int64_t kMostSogFiles = 64;
constexpr const char* kSogMeta = "meta.json";
constexpr int64_t kMostPixels = int64_t{16383} * 16383;  // of a WebP image
constexpr int64_t kSparePixels = 65536;                  // images are padded
constexpr int64_t kPlausibleCount = 1 << 20, kMostPerByte = 64;

class SogReader {
 public:
  /// `files` by their names, which have `bytes` bytes where they are stored.
  SogReader(std::map<std::string, std::string> files, size_t bytes, const std::string& file)
      : file_(file), files_(std::move(files)) {
    const auto meta = files_.find(kSogMeta);
    if (meta == files_.end()) throw InputError("{}: has no meta.json; is it a splat in SOG format?", file_);
    meta_ = ParseUniqueJson(meta->second, file_, "meta.json");
    if (!meta_.is_object()) throw InputError("{}: its meta.json is no object; export it again", file_);
    const nlohmann::json version = meta_.value("version", nlohmann::json(1));  // the first one has no number
    if (version != kSogVersion) {
      throw InputError(
          "{}: is SOG of version {}, and only {} can be read; write it anew with a newer SuperSplat "
          "or splat-transform",
          file_, version.is_number() ? version.dump() : "an unknown one", kSogVersion);
    }
    count_ = Integer(meta_, "count", kMostPixels);
    // Images of one color pack without limit, and each Gaussian takes 240 bytes of memory.
    if (count_ > kPlausibleCount && count_ / kMostPerByte > static_cast<int64_t>(bytes)) {
      throw InputError("{}: promises {} Gaussians in {} bytes; the file is damaged", file_, count_, bytes);
    }
  }

  GaussianPly Read() {
    const nlohmann::json harmonics = meta_.value("shN", nlohmann::json());
    const int degree = harmonics.is_null() ? 0 : static_cast<int>(Integer(harmonics, "bands", kMaxShDegree));
    const ByteImage low = Pixels("means", 0), high = Pixels("means", 1);  // before memory is taken for Gaussians
    GaussianPly splat = ZeroSplat(count_, degree, file_);
    splat.antialiased = meta_.value(kSogModel, nlohmann::json()) == kSogAntialiased;
    ReadMeans(low, high, splat.gaussians);
    ReadRotations(Pixels("quats", 0), splat.gaussians);
    const std::vector<float> scales = Codebook("scales"), colors = Codebook("sh0");
    const ByteImage scale_pixels = Pixels("scales", 0), color_pixels = Pixels("sh0", 0);
    const GaussianRows all = splat.gaussians.Rows();
    ForEach([&](int64_t i) {
      const GaussianRows g = all.From(i);
      const uint8_t *scale = scale_pixels.rgba.data() + 4 * i, *color = color_pixels.rgba.data() + 4 * i;
      for (int c = 0; c < 3; ++c) {
        g.log_scales[c] = scales[scale[c]];
        g.sh[c] = colors[color[c]];
      }
      g.opacity_logits[0] = LogitOfOpacity(static_cast<float>(color[3]) / 255);
    });
    if (degree > 0) ReadHarmonics(harmonics, degree, all);
    if (meta_.contains("support")) {
      const ByteImage image = Pixels("support", 0);
      for (int64_t i = 0; i < count_; ++i) splat.marks.support.push_back(UnpackSupport(image.rgba[4 * i]));
    }
    return WithoutDamaged(std::move(splat), file_);
  }

 private:
  [[noreturn]] void Fail(const std::string& what) const {
    throw InputError("{}: meta.json has no valid {}; export it again", file_, what);
  }

  int64_t Integer(const nlohmann::json& group, const char* key, int64_t most) const {
    const nlohmann::json value = group.is_object() ? group.value(key, nlohmann::json()) : nlohmann::json();
    if (!value.is_number_integer() || value < 0 || value > most) Fail(fmt::format("'{}' (0 to {})", key, most));
    return value.get<int64_t>();
  }

  nlohmann::json Member(const char* group, const char* key) const {
    const nlohmann::json object = meta_.value(group, nlohmann::json());
    if (!object.is_object() || !object.contains(key)) Fail(fmt::format("'{}.{}'", group, key));
    return object[key];
  }

  std::vector<double> Numbers(const char* group, const char* key, size_t count) const {
    const nlohmann::json list = Member(group, key);
    std::vector<double> numbers;
    if (list.is_array()) {
      for (const nlohmann::json& item : list) numbers.push_back(item.is_number() ? item.get<double>() : NAN);
    }
    constexpr double kLargest = std::numeric_limits<float>::max();
    const bool finite = std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::abs(x) <= kLargest; });
    if (numbers.size() != count || !finite) Fail(fmt::format("'{}.{}' of {} numbers", group, key, count));
    return numbers;
  }

  std::vector<float> Codebook(const char* group) const {
    const std::vector<double> numbers = Numbers(group, "codebook", 256);
    return {numbers.begin(), numbers.end()};
  }

  /// The image of this place in the group's list.
  ByteImage Image(const char* group, size_t index, int64_t max_pixels) const {
    const nlohmann::json names = Member(group, "files");
    if (!names.is_array() || names.size() <= index || !names[index].is_string()) Fail(fmt::format("'{}.files'", group));
    const auto name = names[index].get<std::string>();
    const auto found = files_.find(name);
    if (found == files_.end()) throw InputError("{}: has no file {}; export it again", file_, QuotedForMessage(name));
    return DecodeWebp(found->second, max_pixels, file_ + " " + QuotedForMessage(name));
  }

  /// An image with a pixel for each Gaussian.
  ByteImage Pixels(const char* group, size_t index) const {
    ByteImage image = Image(group, index, 4 * count_ + kSparePixels);
    if (int64_t{image.width} * image.height < count_) {
      throw InputError("{}: an image of '{}' has {} x {} pixels for {} Gaussians; export it again", file_, group,
                       image.width, image.height, count_);
    }
    return image;
  }

  template <class F>
  void ForEach(F&& f) const {
    ParallelBlocks(count_, kSplatGrain, [&](int64_t begin, int64_t end) {
      for (int64_t i = begin; i < end; ++i) f(i);
    });
  }

  void ReadMeans(const ByteImage& low, const ByteImage& high, const Gaussians& to) const {
    const std::vector<double> least = Numbers("means", "mins", 3), most = Numbers("means", "maxs", 3);
    ForEach([&](int64_t i) {
      for (int c = 0; c < 3; ++c) {
        const int fixed = low.rgba[4 * i + c] | high.rgba[4 * i + c] << 8;
        const double t = fixed / 65535.;
        to.means[3 * i + c] = FromLogSpace(least[c] * (1 - t) + most[c] * t);
      }
    });
  }

  void ReadRotations(const ByteImage& image, const Gaussians& to) const {
    ForEach([&](int64_t i) {
      const uint8_t* p = image.rgba.data() + 4 * i;
      SmallestThree rotation{p[3] - kSogFirstRotationTag, {}};
      if (rotation.largest < 0)
        throw InputError("{}: the rotation of Gaussian {} is damaged; export it again", file_, i);
      for (int c = 0; c < 3; ++c) rotation.others[c] = (static_cast<float>(p[c]) / 255 * 2 - 1) * kSogSqrtHalf;
      std::copy_n(RestoreLargest(rotation).data(), 4, to.quats.data() + 4 * i);
    });
  }

  void ReadHarmonics(const nlohmann::json& group, int degree, const GaussianRows& all) const {
    const int coefficients = ShCount(degree) - 1;
    const int64_t sets = Integer(group, "count", kSogMostColors);
    const std::vector<float> codebook = Codebook("shN");
    const ByteImage colors = Image("shN", 0, int64_t{kSogMostColors} * coefficients), labels = Pixels("shN", 1);
    if (colors.width != kSogPaletteColumns * coefficients || int64_t{colors.height} * kSogPaletteColumns < sets) {
      throw InputError("{}: the image of the harmonics has {} x {} pixels, expected {} x {}; export it again", file_,
                       colors.width, colors.height, kSogPaletteColumns * coefficients,
                       (sets + kSogPaletteColumns - 1) / kSogPaletteColumns);
    }
    ForEach([&](int64_t i) {
      const int64_t label = labels.rgba[4 * i] | labels.rgba[4 * i + 1] << 8;
      if (label >= sets) throw InputError("{}: the harmonics of Gaussian {} are damaged; export it again", file_, i);
      const uint8_t* set = colors.rgba.data() + 4 * label * coefficients;
      float* sh = all.From(i).sh + 3;
      for (int k = 0; k < coefficients; ++k) {
        for (int c = 0; c < 3; ++c) sh[3 * k + c] = codebook[set[4 * k + c]];
      }
    });
  }

  const std::string& file_;
  std::map<std::string, std::string> files_;
  nlohmann::json meta_;
  int64_t count_ = 0;
};

}  // namespace

GaussianPly DecodeSog(std::string_view bytes, const std::string& file) {
  return SogReader(ReadZip(bytes, kMostSogFiles, file), bytes.size(), file).Read();
}

bool IsSogFolder(const std::filesystem::path& folder) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(folder / kSogMeta, ignored) &&
         std::filesystem::is_regular_file(folder / "means_l.webp", ignored);
}

GaussianPly ReadSogFolder(const std::filesystem::path& folder) {
  const std::string file = folder.string();
  std::map<std::string, std::string> files;
  size_t bytes = 0;
  std::error_code error;
  const std::filesystem::directory_iterator entries(folder, error);
  if (error) throw InputError("{}: cannot be listed: {}; see its rights", file, SystemReason(error));
  for (const auto& entry : entries) {
    const std::string name = entry.path().filename().string();
    std::error_code ignored;
    if ((name != kSogMeta && entry.path().extension() != ".webp") || !entry.is_regular_file(ignored)) continue;
    if (files.size() == kMostSogFiles) {
      throw InputError("{}: has more than {} images; is it a splat?", file, kMostSogFiles);
    }
    bytes += files.emplace(name, ReadFile(entry.path())).first->second.size();
  }
  return SogReader(std::move(files), bytes, file).Read();
}

}  // namespace oraclegs
