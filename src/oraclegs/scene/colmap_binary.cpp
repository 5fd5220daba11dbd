#include "oraclegs/scene/colmap_files.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "oraclegs/core/error.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {
namespace {

static_assert(std::endian::native == std::endian::little, "the .bin files are read by memcpy");

constexpr size_t kKeypointBytes = 24;     // x f64, y f64, point id u64
constexpr size_t kTrackElementBytes = 8;  // image u32, keypoint u32

/// Reads numbers off the front of a file's bytes and refuses to read past their end.
class ByteReader {
 public:
  ByteReader(std::string_view bytes, const std::string& file) : bytes_(bytes), file_(file) {}

  template <class T>
  T Get() {
    T value;
    std::memcpy(&value, Take(sizeof(T)).data(), sizeof(T));
    return value;
  }

  Eigen::Vector3d GetVector3() {
    Eigen::Vector3d v;
    for (double& x : v) x = Get<double>();
    return v;
  }

  /// A count of things that take at least `bytes_each`.
  size_t GetCount(size_t bytes_each, const char* what) {
    const uint64_t count = Get<uint64_t>();
    if (count > bytes_.size() / bytes_each) {
      throw InputError(
          "{}: promises {} {}, but only {} bytes are left; the file is truncated or damaged, copy it again", file_,
          count, what, bytes_.size());
    }
    return static_cast<size_t>(count);
  }

  std::string GetName() {
    const size_t end = bytes_.find('\0');
    if (end == std::string_view::npos) ThrowTruncated();
    std::string name(bytes_.substr(0, end));
    if (std::any_of(name.begin(), name.end(), [](unsigned char c) { return c < ' '; })) {
      throw InputError("{}: an image's name has control characters; the file is damaged, copy it again", file_);
    }
    bytes_.remove_prefix(end + 1);
    return name;
  }

  std::string_view Take(size_t count) {
    if (count > bytes_.size()) ThrowTruncated();
    const std::string_view taken = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return taken;
  }

 private:
  [[noreturn]] void ThrowTruncated() const {
    throw InputError("{}: ends in the middle of an entry; the file is truncated, copy it again", file_);
  }

  std::string_view bytes_;
  const std::string& file_;
};

int GetImageSide(ByteReader& reader, const std::string& file, uint32_t camera_id) {
  const uint64_t side = reader.Get<uint64_t>();
  if (side > kMaxImageSide) {
    throw InputError("{}: camera {} says an image is {} pixels wide or high; the file is damaged", file, camera_id,
                     side);
  }
  return static_cast<int>(side);
}

}  // namespace

ColmapCameras ParseCamerasBinary(std::string_view bytes, const std::string& file) {
  constexpr size_t kSmallestCamera = 24 + 3 * sizeof(double);
  ByteReader reader(bytes, file);
  const size_t count = reader.GetCount(kSmallestCamera, "cameras");
  ColmapCameras cameras;
  for (size_t i = 0; i < count; ++i) {
    const uint32_t id = reader.Get<uint32_t>();
    const int model_id = reader.Get<int32_t>();
    const auto model = CameraModelFromId(model_id);
    if (!model) {
      throw InputError("{}: camera {} has the unknown model id {}, COLMAP 3.8 has 0..10; {}", file, id, model_id,
                       kUndistortNewerModels);
    }
    Intrinsics intrinsics;
    intrinsics.model = *model;
    intrinsics.width = GetImageSide(reader, file, id);
    intrinsics.height = GetImageSide(reader, file, id);
    intrinsics.params.resize(static_cast<size_t>(CameraModelParameterCount(*model)));
    for (double& p : intrinsics.params) p = reader.Get<double>();
    intrinsics.Check(fmt::format("{}: camera {}", file, id));
    if (!cameras.emplace(id, std::move(intrinsics)).second) throw InputError("{}: camera {} is there twice", file, id);
  }
  return cameras;
}

std::vector<ColmapImage> ParseImagesBinary(std::string_view bytes, const std::string& file) {
  constexpr size_t kSmallestImage = 4 + 7 * sizeof(double) + 4 + 1 + 8;
  ByteReader reader(bytes, file);
  const size_t count = reader.GetCount(kSmallestImage, "images");
  std::vector<ColmapImage> images;
  images.reserve(count);
  for (size_t i = 0; i < count; ++i) {
    ColmapImage image;
    image.id = reader.Get<uint32_t>();
    std::array<double, 4> wxyz;
    for (double& q : wxyz) q = reader.Get<double>();
    const Eigen::Vector3d translation = reader.GetVector3();
    image.camera_id = reader.Get<uint32_t>();
    image.name = reader.GetName();
    image.cam_from_world = PoseFromQuaternion(wxyz, translation, file, image.name);
    reader.Take(reader.GetCount(kKeypointBytes, "keypoints") * kKeypointBytes);
    images.push_back(std::move(image));
  }
  return images;
}

std::vector<ColmapPoint> ParsePointsBinary(std::string_view bytes, const std::string& file) {
  constexpr size_t kSmallestPoint = 8 + 3 * sizeof(double) + 3 + sizeof(double) + 8;
  ByteReader reader(bytes, file);
  const size_t count = reader.GetCount(kSmallestPoint, "points");
  std::vector<ColmapPoint> points;
  points.reserve(count);
  for (size_t i = 0; i < count; ++i) {
    ColmapPoint point;
    reader.Take(sizeof(uint64_t));  // the point's id
    point.xyz = reader.GetVector3();
    for (uint8_t& c : point.rgb) c = reader.Get<uint8_t>();
    point.reprojection_error = reader.Get<double>();
    point.image_ids.resize(reader.GetCount(kTrackElementBytes, "track elements"));
    for (uint32_t& id : point.image_ids) {
      id = reader.Get<uint32_t>();
      reader.Take(sizeof(uint32_t));  // the keypoint's index
    }
    points.push_back(std::move(point));
  }
  return points;
}

}  // namespace oraclegs
