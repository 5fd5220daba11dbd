#include "oraclegs/gaussians/ply_header.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>

#include "oraclegs/core/error.h"
#include "oraclegs/core/parallel.h"

namespace oraclegs {
namespace {

static_assert(std::endian::native == std::endian::little, "binary numbers are read as the machine stores them");

constexpr int64_t kReadGrain = 4096;  // rows a task
constexpr uint64_t kAsciiNumber = 2;  // bytes of the shortest number with its separator

template <class T>
T Load(const char* bytes, bool swap) {
  char raw[sizeof(T)];
  for (size_t i = 0; i < sizeof(T); ++i) raw[i] = bytes[swap ? sizeof(T) - 1 - i : i];
  T value;
  std::memcpy(&value, raw, sizeof(T));
  return value;
}

/// One binary number. Every type fits a double exactly.
double LoadNumber(const char* bytes, PlyType type, bool swap) {
  switch (type) {
    case PlyType::kInt8:
      return Load<int8_t>(bytes, swap);
    case PlyType::kUint8:
      return Load<uint8_t>(bytes, swap);
    case PlyType::kInt16:
      return Load<int16_t>(bytes, swap);
    case PlyType::kUint16:
      return Load<uint16_t>(bytes, swap);
    case PlyType::kInt32:
      return Load<int32_t>(bytes, swap);
    case PlyType::kUint32:
      return Load<uint32_t>(bytes, swap);
    case PlyType::kFloat:
      return static_cast<double>(Load<float>(bytes, swap));
    case PlyType::kDouble:
      return Load<double>(bytes, swap);
  }
  return 0;
}

/// The float nearest to a value; what lies beyond becomes infinite (a plain cast would be undefined).
float ToFloat(double value) {
  constexpr double kMaxFloat = std::numeric_limits<float>::max();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  if (std::abs(value) <= kMaxFloat || std::isnan(value)) return static_cast<float>(value);
  return value > 0 ? kInfinity : -kInfinity;
}

/// A property that is read, and its place in the output row.
struct Column {
  int property;
  size_t place;
};

/// Walks the body of a file number by number, never past its end.
class BodyReader {
 public:
  BodyReader(std::string_view bytes, const PlyHeader& header, const std::string& file)
      : bytes_(bytes), position_(header.body), format_(header.format), file_(file) {}

  /// The minimum bytes of a row: its exact size for a binary element without lists.
  uint64_t MinRowBytes(const PlyElement& element) const {
    uint64_t sum = 0;
    for (const PlyProperty& p : element.properties) {
      sum += format_ == PlyFormat::kAscii ? kAsciiNumber : PlySize(p.is_list ? p.count_type : p.type);
    }
    return sum;
  }

  /// Throws when the rest of the file is too short for the element.
  void RequireRows(const PlyElement& element) const {
    const uint64_t row = MinRowBytes(element);
    const uint64_t slack = format_ == PlyFormat::kAscii ? 1 : 0;  // the last number needs no separator
    if (row == 0 || element.count <= (Left() + slack) / row) return;
    throw InputError(
        "{}: promises {} of element '{}', but the {} bytes after the header hold {} at most; the file is cut "
        "short, copy it again",
        file_, element.count, element.name, Left(), (Left() + slack) / row);
  }

  void Skip(const PlyElement& element) {
    RequireRows(element);
    if (element.properties.empty()) return;
    if (format_ != PlyFormat::kAscii && !HasList(element)) {
      position_ += element.count * MinRowBytes(element);
      return;
    }
    for (uint64_t row = 0; row < element.count; ++row) Row(element, nullptr, nullptr);
  }

  void Read(const PlyElement& element, const std::vector<Column>& columns, std::vector<float>* out) {
    RequireRows(element);
    if (columns.empty()) return;  // rows may then have no bytes, so that their number cannot be checked
    out->resize(element.count * columns.size());
    if (format_ != PlyFormat::kAscii && !HasList(element)) return ReadFixedRows(element, columns, out->data());
    std::vector<int> place(element.properties.size(), -1);
    for (const Column& c : columns) place[c.property] = static_cast<int>(c.place);
    for (uint64_t row = 0; row < element.count; ++row) Row(element, &place, out->data() + row * columns.size());
  }

 private:
  uint64_t Left() const { return bytes_.size() - position_; }

  static bool HasList(const PlyElement& element) {
    for (const PlyProperty& p : element.properties) {
      if (p.is_list) return true;
    }
    return false;
  }

  void ReadFixedRows(const PlyElement& element, const std::vector<Column>& columns, float* out) const {
    std::vector<size_t> offsets;
    size_t stride = 0;
    for (const PlyProperty& p : element.properties) {
      offsets.push_back(stride);
      stride += PlySize(p.type);
    }
    const bool swap = format_ == PlyFormat::kBigEndian;
    const char* rows = bytes_.data() + position_;
    ParallelBlocks(static_cast<int64_t>(element.count), kReadGrain, [&](int64_t begin, int64_t end) {
      for (int64_t row = begin; row < end; ++row) {
        for (const Column& c : columns) {
          const double value =
              LoadNumber(rows + row * stride + offsets[c.property], element.properties[c.property].type, swap);
          out[row * columns.size() + c.place] = ToFloat(value);
        }
      }
    });
  }

  /// Reads or, without `place`, skips one row.
  void Row(const PlyElement& element, const std::vector<int>* place, float* out) {
    for (size_t i = 0; i < element.properties.size(); ++i) {
      const PlyProperty& p = element.properties[i];
      if (p.is_list) {
        SkipList(p, element);
        continue;
      }
      const double value = Number(p.type, element);
      if (place != nullptr && (*place)[i] >= 0) out[(*place)[i]] = ToFloat(value);
    }
  }

  void SkipList(const PlyProperty& property, const PlyElement& element) {
    const double length = Number(property.count_type, element);
    const uint64_t number = format_ == PlyFormat::kAscii ? kAsciiNumber : PlySize(property.type);
    if (!(length >= 0) || length > static_cast<double>(Left() / number + 1)) {
      throw InputError(
          "{}: a list '{}' of element '{}' has a length of {}, more than the file holds; write the file "
          "anew",
          file_, property.name, element.name, length);
    }
    for (uint64_t i = 0; i < static_cast<uint64_t>(length); ++i) Number(property.type, element);
  }

  double Number(PlyType type, const PlyElement& element) {
    if (format_ == PlyFormat::kAscii) return AsciiNumber(element);
    const size_t size = PlySize(type);
    if (Left() < size) {
      throw InputError("{}: ends within element '{}'; the file is cut short, copy it again", file_, element.name);
    }
    const double value = LoadNumber(bytes_.data() + position_, type, format_ == PlyFormat::kBigEndian);
    position_ += size;
    return value;
  }

  double AsciiNumber(const PlyElement& element) {
    constexpr std::string_view kBlank = " \t\r\n";
    const size_t begin = bytes_.find_first_not_of(kBlank, position_);
    if (begin == std::string_view::npos) {
      throw InputError("{}: ends within element '{}'; the file is cut short, copy it again", file_, element.name);
    }
    const size_t end = std::min(bytes_.find_first_of(kBlank, begin), bytes_.size());
    position_ = end;
    const char* first = bytes_.data() + begin + (bytes_[begin] == '+' ? 1 : 0);
    double value = 0;
    const auto [stop, error] = std::from_chars(first, bytes_.data() + end, value);
    if (error == std::errc::result_out_of_range)
      return std::strtod(std::string(first, stop).c_str(), nullptr);  // 0, inf
    if (error != std::errc() || stop != bytes_.data() + end) {
      throw InputError("{}: element '{}' holds something that is not a number at byte {}; write the file anew", file_,
                       element.name, begin);
    }
    return value;
  }

  std::string_view bytes_;
  size_t position_;
  PlyFormat format_;
  const std::string& file_;
};

}  // namespace

std::vector<float> ReadPlyColumns(std::string_view bytes, const PlyHeader& header, std::string_view element,
                                  const std::vector<std::string>& names, const std::string& file) {
  const int index = header.Find(element);
  if (index < 0) throw InputError("{}: has no element '{}'; is it a Gaussian point cloud?", file, element);
  const PlyElement& found = header.elements[index];
  std::vector<Column> columns;
  for (size_t i = 0; i < names.size(); ++i) {
    const int property = found.Find(names[i]);
    if (property < 0) {
      throw InputError("{}: element '{}' has no property '{}'; is it a Gaussian point cloud?", file, found.name,
                       names[i]);
    }
    if (found.properties[property].is_list) {
      throw InputError("{}: property '{}' is a list, expected one number", file, names[i]);
    }
    columns.push_back({property, i});
  }
  BodyReader reader(bytes, header, file);
  for (int i = 0; i < index; ++i) reader.Skip(header.elements[i]);
  std::vector<float> values;
  reader.Read(found, columns, &values);
  return values;
}

}  // namespace oraclegs
