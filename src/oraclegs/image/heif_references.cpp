#include "oraclegs/image/heif_references.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <vector>

namespace oraclegs {
namespace {

constexpr int kMaxPieceDepth = 8, kMaxPieces = 10000;
constexpr size_t kFullBoxHead = 4;  // version and flags

/// Big-endian numbers off the front of bytes; zeros where they end.
class HeifNumbers {
 public:
  explicit HeifNumbers(std::string_view bytes) : left_(bytes) {}

  bool Has(size_t count) const { return left_.size() >= count; }
  uint64_t Take(size_t count) {
    uint64_t value = 0;
    for (size_t i = 0; i < count; ++i) value = value << 8 | (i < left_.size() ? static_cast<uint8_t>(left_[i]) : 0);
    left_.remove_prefix(std::min(count, left_.size()));
    return value;
  }

 private:
  std::string_view left_;
};

/// Calls use(type, body) for each box of a list of them.
void ForEachHeifBox(std::string_view bytes,
                    const std::function<void(std::string_view type, std::string_view body)>& use) {
  while (bytes.size() >= 8) {
    HeifNumbers head(bytes);
    uint64_t size = head.Take(4), begin = 8;
    if (size == 1 && bytes.size() >= 16) size = HeifNumbers(bytes.substr(8)).Take(8), begin = 16;
    if (size == 0 || size > bytes.size()) size = bytes.size();  // the last one
    if (size < begin) return;
    use(bytes.substr(4, 4), bytes.substr(begin, size - begin));
    bytes.remove_prefix(size);
  }
}

using Pieces = std::map<uint64_t, std::vector<uint64_t>>;

/// Adds the images that each image is decoded with: those it is made of, and its alpha channel, which refers to it.
void AddPieces(std::string_view references, Pieces* pieces) {
  if (references.size() < kFullBoxHead) return;
  const size_t id_bytes = references[0] == 0 ? 2 : 4;
  ForEachHeifBox(references.substr(kFullBoxHead), [&](std::string_view type, std::string_view body) {
    HeifNumbers numbers(body);
    const uint64_t from = numbers.Take(id_bytes), count = numbers.Take(2);
    for (uint64_t i = 0; i < count && numbers.Has(id_bytes); ++i) {
      const uint64_t to = numbers.Take(id_bytes);
      if (type == "dimg") (*pieces)[from].push_back(to);
      if (type == "auxl") (*pieces)[to].push_back(from);
    }
  });
}

bool IsFinite(const Pieces& pieces, uint64_t image, int depth, int* count) {
  if (depth > kMaxPieceDepth || ++*count > kMaxPieces) return false;
  const auto found = pieces.find(image);
  if (found == pieces.end()) return true;
  for (const uint64_t piece : found->second) {
    if (!IsFinite(pieces, piece, depth + 1, count)) return false;
  }
  return true;
}

}  // namespace

bool HasFinitePieces(std::string_view heif) {
  Pieces pieces;
  std::vector<uint64_t> main;
  ForEachHeifBox(heif, [&](std::string_view type, std::string_view body) {
    if (type != "meta" || body.size() < kFullBoxHead) return;
    ForEachHeifBox(body.substr(kFullBoxHead), [&](std::string_view inner, std::string_view content) {
      if (inner == "iref") AddPieces(content, &pieces);
      if (inner == "pitm" && content.size() > kFullBoxHead) {
        main.push_back(HeifNumbers(content.substr(kFullBoxHead)).Take(content[0] == 0 ? 2 : 4));
      }
    });
  });
  for (const uint64_t image : main) {
    int count = 0;
    if (!IsFinite(pieces, image, 0, &count)) return false;
  }
  return true;
}

}  // namespace oraclegs
