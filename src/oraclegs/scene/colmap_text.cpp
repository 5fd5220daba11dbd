#include "oraclegs/scene/colmap_files.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <type_traits>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMaxShown = 40;  // characters of a word in an error message
constexpr std::string_view kBlanks = " \t\r\v\f";

std::string_view Trim(std::string_view s) {
  const size_t first = s.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return s.substr(first, s.find_last_not_of(kBlanks) - first + 1);
}

bool HasControlCharacter(const std::string& name) {
  return std::any_of(name.begin(), name.end(), [](unsigned char c) { return c < ' '; });
}

/// The whole word as a number; other programs write +1, and 100.0 where a whole number stands.
template <class T>
std::optional<T> NumberOf(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc() && end == word.data() + word.size()) return value;
  if constexpr (std::is_integral_v<T>) {
    const auto whole = NumberOf<double>(word);
    const bool fits = whole && *whole == std::trunc(*whole) && *whole >= 0 &&
                      *whole <= static_cast<double>(std::numeric_limits<T>::max());
    if (fits) return static_cast<T>(*whole);
  }
  return std::nullopt;
}

/// Walks over the lines of a file; remembers the number of the last one for messages.
class LineReader {
 public:
  LineReader(std::string_view text, const std::string& file) : text_(text), file_(file) {
    if (text_.starts_with("\xFF\xFE") || text_.starts_with("\xFE\xFF")) {
      throw InputError("{}: is UTF-16 text; save it as UTF-8", file);
    }
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (text_.starts_with(kByteOrderMark)) text_.remove_prefix(kByteOrderMark.size());
  }

  /// The next line without blanks at its ends, nullopt at the end of the file.
  std::optional<std::string_view> NextRaw() {
    if (text_.empty()) return std::nullopt;
    const size_t end = std::min(text_.find('\n'), text_.size());
    const std::string_view line = Trim(text_.substr(0, end));
    text_.remove_prefix(std::min(end + 1, text_.size()));
    ++number_;
    return line;
  }

  /// The line that NextRaw will give; the place stays where it is.
  std::optional<std::string_view> Peek() const {
    LineReader ahead = *this;
    return ahead.NextRaw();
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
    const auto value = NumberOf<T>(word);
    if (!value) {
      throw InputError("{}: '{}' is not a number that {} can be", reader_.Place(), Printable(word, kMaxShown), what);
    }
    return *value;
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

/// The points as lines of points3D.txt, and the keypoints that their tracks refer to. Ids begin at 1.
class Tracks {
 public:
  explicit Tracks(const std::vector<ColmapTrack>& points) {
    for (size_t p = 0; p < points.size(); ++p) {
      const ColmapTrack& point = points[p];
      points_ += fmt::format("{} {} {} {} {} {} {} 0", p + 1, point.xyz.x(), point.xyz.y(), point.xyz.z(), point.rgb[0],
                             point.rgb[1], point.rgb[2]);
      for (const ColmapObservation& seen : point.observations) {
        Lines& lines = by_image_[seen.image_id];
        points_ += fmt::format(" {} {}", seen.image_id, lines.count++);
        lines.text += fmt::format("{}{} {} {}", lines.text.empty() ? "" : " ", seen.pixel.x(), seen.pixel.y(), p + 1);
      }
      points_ += "\n";
    }
  }

  const std::string& points() const { return points_; }
  std::string Keypoints(uint32_t image) const {
    const auto it = by_image_.find(image);
    return it == by_image_.end() ? "" : it->second.text;
  }

 private:
  struct Lines {
    size_t count = 0;
    std::string text;
  };
  std::map<uint32_t, Lines> by_image_;
  std::string points_;
};

/// X Y POINT3D_ID for each keypoint, or nothing. A name with blanks can have any number of words, but is no number.
bool IsKeypointsLine(std::string_view line) {
  size_t words = 0;
  while (!line.empty()) {
    const size_t end = std::min(line.find_first_of(kBlanks), line.size());
    if (!NumberOf<double>(line.substr(0, end))) return false;
    line = Trim(line.substr(end));
    ++words;
  }
  return words % 3 == 0;
}

/// IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID and a name.
bool IsImageLine(std::string_view line) {
  constexpr int kNumbers = 9;
  for (int i = 0; i < kNumbers; ++i) {
    const size_t end = std::min(line.find_first_of(kBlanks), line.size());
    const std::string_view word = line.substr(0, end);
    const bool whole = i == 0 || i == kNumbers - 1;
    if (whole ? !NumberOf<uint32_t>(word) : !NumberOf<double>(word)) return false;
    line = Trim(line.substr(end));
  }
  return !line.empty();
}

/// Passes over an image's line of keypoints, and comments before it. Some programs write none, not even an empty line:
/// then the next image's line is left.
void SkipKeypoints(LineReader& lines, const std::string& image) {
  while (const auto line = lines.Peek()) {
    if (IsKeypointsLine(*line)) {
      lines.NextRaw();
      return;
    }
    if (line->front() != '#') {
      if (IsImageLine(*line)) return;
      lines.NextRaw();
      throw InputError(
          "{}: expected the keypoints (X Y POINT3D_ID ...) of image '{}', an empty line, or the next image",
          lines.Place(), image);
    }
    lines.NextRaw();
  }
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
    if (!model) {
      throw InputError("{}: unknown camera model '{}', COLMAP 3.8 has eleven; {}", lines.Place(),
                       Printable(model_name, kMaxShown), kUndistortNewerModels);
    }
    Intrinsics intrinsics;
    intrinsics.model = *model;
    intrinsics.width = ImageSide(fields, lines);
    intrinsics.height = ImageSide(fields, lines);
    while (!fields.empty()) intrinsics.params.push_back(fields.Number<double>("a camera parameter"));
    intrinsics.Check(fmt::format("{}: camera {}", file, id));
    if (!cameras.emplace(id, std::move(intrinsics)).second) throw InputError("{}: camera {} is there twice", file, id);
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
    if (image.name.empty() || HasControlCharacter(image.name)) {
      throw InputError("{}: the image's name is missing or has control characters", lines.Place());
    }
    image.cam_from_world = PoseFromQuaternion(wxyz, translation, file, image.name);
    images.push_back(std::move(image));
    SkipKeypoints(lines, images.back().name);
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
    for (uint8_t& c : point.rgb) c = fields.Number<uint8_t>("the color");
    point.reprojection_error = fields.Number<double>("the reprojection error");
    while (!fields.empty()) {
      point.image_ids.push_back(fields.Number<uint32_t>("an image id"));
      fields.Word("a keypoint index");
    }
    points.push_back(std::move(point));
  }
  return points;
}

void WriteColmapText(const fs::path& dir, const ColmapCameras& cameras, const std::vector<ColmapImage>& images,
                     const std::vector<ColmapTrack>& points) {
  const Tracks tracks(points);
  std::string text = "# CAMERA_ID MODEL WIDTH HEIGHT PARAMS[]\n";
  for (const auto& [id, intrinsics] : cameras) {
    text += fmt::format("{} {} {} {} {}\n", id, CameraModelName(intrinsics.model), intrinsics.width, intrinsics.height,
                        fmt::join(intrinsics.params, " "));
  }
  WriteFileAtomically(dir / "cameras.txt", text);

  text = "# IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME, then a line of keypoints\n";
  for (const ColmapImage& image : images) {
    if (image.name.empty() || image.name.find_first_of(" \t\r\n\v\f") != std::string::npos) {
      throw InputError("{}: COLMAP's text format cannot hold the image name '{}'; rename the photo without blanks",
                       (dir / "images.txt").string(), image.name);
    }
    Eigen::Quaterniond q(image.cam_from_world.linear());
    q.normalize();
    if (q.w() < 0) q.coeffs() = -q.coeffs();
    const Eigen::Vector3d t = image.cam_from_world.translation();
    text += fmt::format("{} {} {} {} {} {} {} {} {} {}\n{}\n", image.id, q.w(), q.x(), q.y(), q.z(), t.x(), t.y(),
                        t.z(), image.camera_id, image.name, tracks.Keypoints(image.id));
  }
  WriteFileAtomically(dir / "images.txt", text);
  WriteFileAtomically(dir / "points3D.txt", "# POINT3D_ID X Y Z R G B ERROR TRACK[]\n" + tracks.points());
}

}  // namespace oraclegs
