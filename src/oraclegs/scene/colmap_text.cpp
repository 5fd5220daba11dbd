#include "oraclegs/scene/colmap_text.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <optional>

#include "oraclegs/core/error.h"
#include "oraclegs/scene/scene_validation.h"

namespace oraclegs {
namespace {

constexpr size_t kMaxShown = 40;  // characters of a word in an error message
constexpr std::string_view kBlanks = " \t\r\v\f";

std::string_view Trim(std::string_view s) {
  const size_t first = s.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return s.substr(first, s.find_last_not_of(kBlanks) - first + 1);
}

/// A word for an error message: short and printable, whatever the file holds.
std::string Shown(std::string_view word) {
  std::string shown(word.substr(0, kMaxShown));
  std::replace_if(
      shown.begin(), shown.end(), [](unsigned char c) { return c < ' '; }, '?');
  return shown;
}

/// Walks over the lines of a file; remembers the number of the last one for messages.
class LineReader {
 public:
  LineReader(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  /// The next line without blanks at its ends, nullopt at the end of the file.
  std::optional<std::string_view> NextRaw() {
    if (text_.empty()) return std::nullopt;
    const size_t end = std::min(text_.find('\n'), text_.size());
    const std::string_view line = Trim(text_.substr(0, end));
    text_.remove_prefix(std::min(end + 1, text_.size()));
    ++number_;
    return line;
  }

  /// The next line that is neither empty nor a comment.
  std::optional<std::string_view> Next() {
    while (const auto line = NextRaw()) {
      if (!line->empty() && line->front() != '#') return line;
    }
    return std::nullopt;
  }

  std::string Place() const { return fmt::format("{} line {}", file_, number_); }

 private:
  std::string_view text_;
  const std::string& file_;
  int number_ = 0;
};

/// The blank-separated fields of one line.
class Fields {
 public:
  Fields(std::string_view line, const LineReader& reader) : rest_(line), reader_(reader) {}

  bool empty() const { return rest_.empty(); }

  std::string_view Word(const char* what) {
    if (rest_.empty())
      throw InputError("{}: ends before {}; the file is truncated or not COLMAP's", reader_.Place(), what);
    const size_t end = std::min(rest_.find_first_of(kBlanks), rest_.size());
    const std::string_view word = rest_.substr(0, end);
    rest_ = Trim(rest_.substr(end));
    return word;
  }

  template <class T>
  T Number(const char* what) {
    const std::string_view word = Word(what);
    T value{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size()) {
      throw InputError("{}: '{}' is not a number that {} can be", reader_.Place(), Shown(word), what);
    }
    return value;
  }

  Eigen::Vector3d Vector3(const char* what) {
    Eigen::Vector3d v;
    for (double& x : v) x = Number<double>(what);
    return v;
  }

  std::string_view Rest() const { return rest_; }

 private:
  std::string_view rest_;
  const LineReader& reader_;
};

int ImageSide(Fields& fields, const LineReader& reader) {
  const int side = fields.Number<int>("the image size");
  if (side > kMaxImageSide) throw InputError("{}: an image side of {} pixels is a damaged file", reader.Place(), side);
  return side;
}

size_t CountWords(std::string_view line) {
  size_t words = 0;
  bool in_word = false;
  for (const char c : line) {
    const bool blank = kBlanks.find(c) != std::string_view::npos;
    words += !blank && !in_word;
    in_word = !blank;
  }
  return words;
}

}  // namespace

ColmapCameras ParseCamerasText(std::string_view text, const std::string& file) {
  LineReader lines(text, file);
  ColmapCameras cameras;
  while (const auto line = lines.Next()) {
    Fields fields(*line, lines);
    const uint32_t id = fields.Number<uint32_t>("the camera id");
    const std::string_view model_name = fields.Word("the camera model");
    const auto model = CameraModelFromName(model_name);
    if (!model)
      throw InputError("{}: unknown camera model '{}', COLMAP 3.8 has eleven", lines.Place(), Shown(model_name));
    Intrinsics lens;
    lens.model = *model;
    lens.width = ImageSide(fields, lines);
    lens.height = ImageSide(fields, lines);
    while (!fields.empty()) lens.params.push_back(fields.Number<double>("a camera parameter"));
    lens.Check(fmt::format("{}: camera {}", file, id));
    if (!cameras.emplace(id, std::move(lens)).second) throw InputError("{}: camera {} is there twice", file, id);
  }
  return cameras;
}

std::vector<ColmapImage> ParseImagesText(std::string_view text, const std::string& file) {
  LineReader lines(text, file);
  std::vector<ColmapImage> images;
  while (const auto line = lines.Next()) {
    Fields fields(*line, lines);
    ColmapImage image;
    image.id = fields.Number<uint32_t>("the image id");
    std::array<double, 4> wxyz;
    for (double& q : wxyz) q = fields.Number<double>("the rotation");
    const Eigen::Vector3d translation = fields.Vector3("the translation");
    image.camera_id = fields.Number<uint32_t>("the camera id");
    image.name = std::string(fields.Rest());
    if (image.name.empty() || Shown(image.name) != image.name.substr(0, kMaxShown)) {
      throw InputError("{}: the image's name is missing or has control characters", lines.Place());
    }
    image.cam_from_world = PoseFromQuaternion(wxyz, translation, file, image.name);
    images.push_back(std::move(image));
    const auto keypoints = lines.NextRaw();
    if (keypoints && CountWords(*keypoints) % 3 != 0) {
      throw InputError(
          "{}: expected the keypoints (X Y POINT3D_ID ...) of image '{}' or an empty line; every image takes "
          "two lines",
          lines.Place(), images.back().name);
    }
  }
  return images;
}

std::vector<ColmapPoint> ParsePointsText(std::string_view text, const std::string& file) {
  LineReader lines(text, file);
  std::vector<ColmapPoint> points;
  while (const auto line = lines.Next()) {
    Fields fields(*line, lines);
    ColmapPoint point;
    fields.Word("the point's id");
    point.xyz = fields.Vector3("the position");
    for (uint8_t& c : point.rgb) c = fields.Number<uint8_t>("the colour");
    point.reprojection_error = fields.Number<double>("the reprojection error");
    while (!fields.empty()) {
      point.image_ids.push_back(fields.Number<uint32_t>("an image id"));
      fields.Word("a keypoint index");
    }
    points.push_back(std::move(point));
  }
  return points;
}

}  // namespace oraclegs
