#include "oraclegs/gaussians/ply_header.h"

#include <algorithm>
#include <charconv>
#include <set>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

constexpr std::pair<std::string_view, PlyType> kTypeNames[] = {
    {"char", PlyType::kInt8},     {"int8", PlyType::kInt8},     {"uchar", PlyType::kUint8},
    {"uint8", PlyType::kUint8},   {"short", PlyType::kInt16},   {"int16", PlyType::kInt16},
    {"ushort", PlyType::kUint16}, {"uint16", PlyType::kUint16}, {"int", PlyType::kInt32},
    {"int32", PlyType::kInt32},   {"uint", PlyType::kUint32},   {"uint32", PlyType::kUint32},
    {"float", PlyType::kFloat},   {"float32", PlyType::kFloat}, {"double", PlyType::kDouble},
    {"float64", PlyType::kDouble}};
constexpr size_t kShownChars = 60;  // of a line quoted in a message
constexpr size_t kMaxComments = 100, kMaxCommentChars = 1000;
constexpr size_t kMaxNames = 10000;  // of elements and properties; files have at most some hundred

/// The words of a line, separated by blanks and tabs.
std::vector<std::string_view> Words(std::string_view line) {
  std::vector<std::string_view> words;
  size_t begin = 0;
  while ((begin = line.find_first_not_of(" \t", begin)) != std::string_view::npos) {
    const size_t end = std::min(line.find_first_of(" \t", begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = end;
  }
  return words;
}

class HeaderParser {
 public:
  HeaderParser(std::string_view bytes, const std::string& file) : bytes_(bytes), file_(file) {}

  PlyHeader Parse() {
    if (NextLine() != "ply") {
      throw InputError("{}: not a PLY file (the first line is not 'ply'); give a .ply point cloud", file_);
    }
    while (true) {
      const std::string_view line = NextLine();
      const std::vector<std::string_view> words = Words(line);
      if (!words.empty() && words[0] == "comment") AddComment(line);
      if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
      if (words[0] == "end_header") break;
      if (!ParseLine(words)) {
        throw InputError("{}: line {} of the header is not understood: '{}'", file_, line_,
                         Printable(line, kShownChars));
      }
    }
    if (!has_format_) throw InputError("{}: the header has no format line; write the file anew", file_);
    header_.body = position_;
    return std::move(header_);
  }

 private:
  std::string_view NextLine() {
    const size_t end = bytes_.find('\n', position_);
    if (end == std::string_view::npos) {
      throw InputError("{}: ends within the PLY header (no end_header); copy the whole file again", file_);
    }
    std::string_view line = bytes_.substr(position_, end - position_);
    position_ = end + 1;
    ++line_;
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return line;
  }

  void AddComment(std::string_view line) {
    if (header_.comments.size() == kMaxComments) return;
    line.remove_prefix(line.find("comment") + std::string_view("comment").size());
    line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
    header_.comments.emplace_back(line.substr(0, kMaxCommentChars));
  }

  bool ParseLine(const std::vector<std::string_view>& words) {
    if (words[0] == "format") return ParseFormat(words);
    if (words[0] == "element") return ParseElement(words);
    if (words[0] == "property") return ParseProperty(words);
    return false;
  }

  bool ParseFormat(const std::vector<std::string_view>& words) {
    if (words.size() != 3 || words[2] != "1.0" || has_format_) return false;
    has_format_ = true;
    if (words[1] == "ascii") {
      header_.format = PlyFormat::kAscii;
    } else if (words[1] == "binary_little_endian") {
      header_.format = PlyFormat::kLittleEndian;
    } else if (words[1] == "binary_big_endian") {
      header_.format = PlyFormat::kBigEndian;
    } else {
      return false;
    }
    return true;
  }

  bool ParseElement(const std::vector<std::string_view>& words) {
    if (words.size() != 3) return false;
    PlyElement element;
    element.name = words[1];
    if (!IsNew(0, element.name)) return false;
    const char* end = words[2].data() + words[2].size();
    const auto [stop, error] = std::from_chars(words[2].data(), end, element.count);
    if (error != std::errc() || stop != end) return false;
    header_.elements.push_back(std::move(element));
    return true;
  }

  bool ParseProperty(const std::vector<std::string_view>& words) {
    if (header_.elements.empty()) return false;
    PlyElement& element = header_.elements.back();
    PlyProperty property;
    property.is_list = words.size() == 5 && words[1] == "list";
    if (!property.is_list && words.size() != 3) return false;
    if (property.is_list && (!TypeOf(words[2], &property.count_type) || property.count_type >= PlyType::kFloat)) {
      return false;
    }
    if (!TypeOf(words[words.size() - 2], &property.type)) return false;
    property.name = words.back();
    if (!IsNew(header_.elements.size(), property.name)) return false;
    element.properties.push_back(std::move(property));
    return true;
  }

  /// Remembers a name of the element with this number from 1, or of an element itself (0).
  bool IsNew(size_t element, const std::string& name) {
    if (names_.size() == kMaxNames) {
      throw InputError("{}: has more than {} elements and properties; is it a point cloud?", file_, kMaxNames);
    }
    return names_.insert({element, name}).second;
  }

  static bool TypeOf(std::string_view word, PlyType* type) {
    for (const auto& [name, value] : kTypeNames) {
      if (name != word) continue;
      *type = value;
      return true;
    }
    return false;
  }

  std::string_view bytes_;
  const std::string& file_;
  size_t position_ = 0;
  int64_t line_ = 0;
  bool has_format_ = false;
  std::set<std::pair<size_t, std::string>> names_;  // (element from 1, property) and (0, element), to find duplicates
  PlyHeader header_;
};

}  // namespace

size_t PlySize(PlyType type) {
  switch (type) {
    case PlyType::kInt8:
    case PlyType::kUint8:
      return 1;
    case PlyType::kInt16:
    case PlyType::kUint16:
      return 2;
    case PlyType::kInt32:
    case PlyType::kUint32:
    case PlyType::kFloat:
      return 4;
    case PlyType::kDouble:
      return 8;
  }
  return 0;
}

int PlyElement::Find(std::string_view property) const {
  for (size_t i = 0; i < properties.size(); ++i) {
    if (properties[i].name == property) return static_cast<int>(i);
  }
  return -1;
}

int PlyHeader::Find(std::string_view element) const {
  for (size_t i = 0; i < elements.size(); ++i) {
    if (elements[i].name == element) return static_cast<int>(i);
  }
  return -1;
}

PlyHeader ParsePlyHeader(std::string_view bytes, const std::string& file) { return HeaderParser(bytes, file).Parse(); }

}  // namespace oraclegs
