#include "oraclegs/image/codecs.h"

#include <libheif/heif.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "oraclegs/core/error.h"
#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

// A block of 64 x 64 pixels that repeats its neighbor takes less than a bit.
constexpr uint64_t kHeifPixelsPerByte = uint64_t{1} << 16;
constexpr int kMaxHeifSide = 1 << 16;
constexpr int kFreeHeifSide = 4096;  // of pieces of a smaller image
constexpr size_t kMaxExifBytes = 1 << 20;

struct FreeHeif {
  void operator()(heif_context* context) const { heif_context_free(context); }
  void operator()(heif_image_handle* handle) const { heif_image_handle_release(handle); }
  void operator()(heif_image* image) const { heif_image_release(image); }
  void operator()(heif_decoding_options* options) const { heif_decoding_options_free(options); }
};
template <class T>
using Heif = std::unique_ptr<T, FreeHeif>;

struct OpenHeif {
  Heif<heif_context> context;
  Heif<heif_image_handle> image;
};

[[noreturn]] void RefuseHeif(const heif_error& error, std::string_view bytes, const std::string& file) {
  if (error.subcode == heif_suberror_Unsupported_codec || error.code == heif_error_Decoder_plugin_error) {
    const bool is_avif = bytes.substr(8, 4).starts_with("avi");
    throw InputError(
        "{}: this libheif has no decoder for its {} compression; install one (Debian 13: apt install {}), or convert "
        "it "
        "to JPEG (on an iPhone: Settings, Camera, Formats, Most Compatible)",
        file, is_avif ? "AV1" : "HEVC", is_avif ? "libheif-plugin-dav1d" : "libheif-plugin-libde265");
  }
  std::string why = error.message == nullptr ? "unknown" : error.message;
  why = OneLine(why);
  throw InputError("{}: is a damaged or incomplete HEIF image ({}); copy or export it again", file, why);
}

OpenHeif Open(std::string_view bytes, heif_error* error) {
  OpenHeif open;
  open.context.reset(heif_context_alloc());
  if (!open.context) throw RunError("the HEIF decoder cannot start");
  heif_context_set_maximum_image_size_limit(open.context.get(), kMaxHeifSide);
  *error = heif_context_read_from_memory_without_copy(open.context.get(), bytes.data(), bytes.size(), nullptr);
  if (error->code != heif_error_Ok) return open;
  heif_image_handle* handle = nullptr;
  *error = heif_context_get_primary_image_handle(open.context.get(), &handle);
  open.image.reset(handle);
  return open;
}

OpenHeif OpenOrThrow(std::string_view bytes, const std::string& file) {
  if (!HasFinitePieces(bytes)) {
    throw InputError("{}: is a damaged HEIF image (made of itself, or of too many pieces); copy or export it again",
                     file);
  }
  heif_error error{};
  OpenHeif open = Open(bytes, &error);
  if (error.code != heif_error_Ok || !open.image) RefuseHeif(error, bytes, file);
  const heif_image_handle* image = open.image.get();
  const uint64_t possible = bytes.size() * kHeifPixelsPerByte;
  CheckImageSize(heif_image_handle_get_width(image), heif_image_handle_get_height(image), possible, file);
  CheckImageSize(heif_image_handle_get_ispe_width(image), heif_image_handle_get_ispe_height(image), possible, file);
  // An image made of others has a size of its own, which libheif takes memory for without a look at the one of the
  // header.
  const int side = std::max({kFreeHeifSide, heif_image_handle_get_width(image), heif_image_handle_get_height(image),
                             heif_image_handle_get_ispe_width(image), heif_image_handle_get_ispe_height(image)});
  heif_context_set_maximum_image_size_limit(open.context.get(), std::min(side, kMaxHeifSide));
  return open;
}

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

bool IsHeif(std::string_view bytes) {
  static constexpr std::array<std::string_view, 10> kBrands = {"heic", "heix", "heim", "heis", "hevc",
                                                               "hevx", "mif1", "msf1", "avif", "avis"};
  if (bytes.size() < 12 || bytes.substr(4, 4) != "ftyp") return false;
  return std::find(kBrands.begin(), kBrands.end(), bytes.substr(8, 4)) != kBrands.end();
}

Image8 DecodeHeif(std::string_view bytes, const std::string& file) {
  const OpenHeif open = OpenOrThrow(bytes, file);
  const bool has_alpha = heif_image_handle_has_alpha_channel(open.image.get()) != 0;
  const Heif<heif_decoding_options> options(heif_decoding_options_alloc());
  if (!options) throw RunError("{}: the HEIF decoder cannot start", file);
  options->convert_hdr_to_8bit = 1;
  heif_image* decoded = nullptr;
  const heif_error error =
      heif_decode_image(open.image.get(), &decoded, heif_colorspace_RGB,
                        has_alpha ? heif_chroma_interleaved_RGBA : heif_chroma_interleaved_RGB, options.get());
  const Heif<heif_image> pixels(decoded);
  if (error.code != heif_error_Ok || !pixels) RefuseHeif(error, bytes, file);
  int stride = 0;
  const uint8_t* rows = heif_image_get_plane_readonly(pixels.get(), heif_channel_interleaved, &stride);
  Image8 image{heif_image_get_width(pixels.get(), heif_channel_interleaved),
               heif_image_get_height(pixels.get(), heif_channel_interleaved),
               has_alpha ? 4 : 3,
               {}};
  const bool is_whole = rows != nullptr && image.width == heif_image_handle_get_width(open.image.get()) &&
                        image.height == heif_image_handle_get_height(open.image.get()) &&
                        stride >= image.width * image.channels;
  if (!is_whole) throw InputError("{}: is a damaged HEIF image (its size is unclear); export it again", file);
  const size_t row_bytes = static_cast<size_t>(image.width) * static_cast<size_t>(image.channels);
  image.data.resize(row_bytes * static_cast<size_t>(image.height));
  for (int y = 0; y < image.height; ++y) {
    std::copy_n(rows + static_cast<size_t>(y) * static_cast<size_t>(stride), row_bytes,
                image.data.data() + static_cast<size_t>(y) * row_bytes);
  }
  return image;
}

void ReadHeifSize(std::string_view bytes, const std::string& file, int* width, int* height) {
  const OpenHeif open = OpenOrThrow(bytes, file);
  *width = heif_image_handle_get_width(open.image.get());
  *height = heif_image_handle_get_height(open.image.get());
}

std::string ReadHeifExif(std::string_view bytes) {
  heif_error error{};
  const OpenHeif open = Open(bytes, &error);
  if (error.code != heif_error_Ok || !open.image) return "";
  heif_item_id id = 0;
  if (heif_image_handle_get_list_of_metadata_block_IDs(open.image.get(), "Exif", &id, 1) != 1) return "";
  const size_t size = heif_image_handle_get_metadata_size(open.image.get(), id);
  if (size < 4 || size > kMaxExifBytes) return "";
  std::string block(size, '\0');
  if (heif_image_handle_get_metadata(open.image.get(), id, block.data()).code != heif_error_Ok) return "";
  size_t skip = 0;  // four bytes say how many more stand before the TIFF structure
  for (size_t i = 0; i < 4; ++i) skip = skip << 8 | static_cast<unsigned char>(block[i]);
  return skip > size - 4 ? "" : block.substr(4 + skip);
}

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
