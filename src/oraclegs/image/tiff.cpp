#include "oraclegs/image/codecs.h"

#include <tiffio.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <memory>
#include <utility>
#include <vector>

#include "oraclegs/core/error.h"
#include "oraclegs/image/exif.h"

namespace oraclegs {
namespace {

constexpr uint64_t kTiffPixelsPerByte = 8 * 1032;  // deflate packs 1032 to 1 at most, a byte is eight pixels at most
constexpr tmsize_t kMaxTiffAllocation = tmsize_t{1} << 31;  // of one strip or tile

/// The bytes as a file, and what libtiff had to say about them.
struct TiffSource {
  std::string_view bytes;
  uint64_t at = 0;
  std::string error;
};

tmsize_t ReadTiff(thandle_t handle, void* target, tmsize_t count) {
  auto* source = static_cast<TiffSource*>(handle);
  const uint64_t left = source->at < source->bytes.size() ? source->bytes.size() - source->at : 0;
  const auto bytes = static_cast<size_t>(std::min<uint64_t>(left, static_cast<uint64_t>(std::max<tmsize_t>(count, 0))));
  if (bytes > 0) std::memcpy(target, source->bytes.data() + source->at, bytes);
  source->at += bytes;
  return static_cast<tmsize_t>(bytes);
}

tmsize_t WriteNothing(thandle_t, void*, tmsize_t) { return 0; }

toff_t SeekTiff(thandle_t handle, toff_t offset, int whence) {
  auto* source = static_cast<TiffSource*>(handle);
  source->at = whence == SEEK_SET ? offset : offset + (whence == SEEK_CUR ? source->at : source->bytes.size());
  return source->at;
}

int CloseNothing(thandle_t) { return 0; }
toff_t TiffBytes(thandle_t handle) { return static_cast<TiffSource*>(handle)->bytes.size(); }

int KeepTiffError(TIFF*, void* source, const char*, const char* format, va_list arguments) {
  char text[160] = "";
  std::vsnprintf(text, sizeof(text), format, arguments);
  std::string& error = static_cast<TiffSource*>(source)->error;
  if (error.empty()) error = text;
  std::replace(error.begin(), error.end(), '\n', ' ');
  return 1;
}

int DropTiffWarning(TIFF*, void*, const char*, const char*, va_list) { return 1; }

struct CloseTiff {
  void operator()(TIFF* tiff) const { TIFFClose(tiff); }
  void operator()(TIFFOpenOptions* options) const { TIFFOpenOptionsFree(options); }
};
using Tiff = std::unique_ptr<TIFF, CloseTiff>;

[[noreturn]] void RefuseTiff(const TiffSource& source, const std::string& file) {
  throw InputError("{}: is a damaged, incomplete or unusual TIFF ({}); export it as JPEG or PNG", file,
                   source.error.empty() ? "no image" : source.error);
}

Tiff OpenTiff(TiffSource* source, const std::string& file) {
  const std::unique_ptr<TIFFOpenOptions, CloseTiff> options(TIFFOpenOptionsAlloc());
  if (!options) throw RunError("{}: the TIFF decoder cannot start", file);
  TIFFOpenOptionsSetMaxSingleMemAlloc(options.get(), kMaxTiffAllocation);
  TIFFOpenOptionsSetErrorHandlerExtR(options.get(), KeepTiffError, source);
  TIFFOpenOptionsSetWarningHandlerExtR(options.get(), DropTiffWarning, nullptr);
  Tiff tiff(TIFFClientOpenExt("image", "rm", source, ReadTiff, WriteNothing, SeekTiff, CloseNothing, TiffBytes, nullptr,
                              nullptr, options.get()));
  if (!tiff) RefuseTiff(*source, file);
  return tiff;
}

void CheckTiffSize(TIFF* tiff, const TiffSource& source, const std::string& file, int* width, int* height) {
  uint32_t w = 0, h = 0;
  TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &w);
  TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &h);
  CheckImageSize(w, h, source.bytes.size() * kTiffPixelsPerByte, file);
  *width = static_cast<int>(w);
  *height = static_cast<int>(h);
}

int TiffOrientation(TIFF* tiff, Orientation orientation) {
  uint16_t value = 1;
  if (orientation == Orientation::kAsStored || TIFFGetField(tiff, TIFFTAG_ORIENTATION, &value) != 1) return 1;
  return value >= 1 && value <= 8 ? value : 1;
}

/// Rows as they are stored, packed as libtiff packs them, alpha multiplied in.
std::vector<uint32_t> ReadPacked(TIFF* tiff, const TiffSource& source, const std::string& file, bool* has_alpha) {
  char why[1024] = "";
  TIFFRGBAImage reader;
  if (TIFFRGBAImageBegin(&reader, tiff, /*stop=*/1, why) != 1) {
    throw InputError("{}: is a TIFF of an unusual kind ({}); export it as JPEG or PNG", file, why);
  }
  reader.req_orientation = reader.orientation;  // not turned here: libtiff only mirrors
  *has_alpha = reader.alpha != 0;
  std::vector<uint32_t> packed(static_cast<size_t>(reader.width) * reader.height);
  const bool whole = TIFFRGBAImageGet(&reader, packed.data(), reader.width, reader.height) == 1 && source.error.empty();
  TIFFRGBAImageEnd(&reader);
  if (!whole) RefuseTiff(source, file);
  return packed;
}

}  // namespace

bool IsTiff(std::string_view bytes) {
  for (const std::string_view mark : {std::string_view("II*\0", 4), std::string_view("MM\0*", 4),
                                      std::string_view("II+\0", 4), std::string_view("MM\0+", 4)}) {
    if (bytes.starts_with(mark)) return true;
  }
  return false;
}

Image8 DecodeTiff(std::string_view bytes, const std::string& file, Orientation orientation) {
  TiffSource source{bytes, 0, ""};
  const Tiff tiff = OpenTiff(&source, file);
  Image8 image;
  CheckTiffSize(tiff.get(), source, file, &image.width, &image.height);
  bool has_alpha = false;
  const std::vector<uint32_t> packed = ReadPacked(tiff.get(), source, file, &has_alpha);
  has_alpha = has_alpha && std::any_of(packed.begin(), packed.end(), [](uint32_t p) { return TIFFGetA(p) != 255; });
  image.channels = has_alpha ? 4 : 3;
  image.data.reserve(packed.size() * static_cast<size_t>(image.channels));
  for (const uint32_t pixel : packed) {
    const uint32_t alpha = TIFFGetA(pixel);
    for (const uint32_t color : {TIFFGetR(pixel), TIFFGetG(pixel), TIFFGetB(pixel)}) {
      const bool premultiplied = has_alpha && alpha > 0;
      image.data.push_back(static_cast<uint8_t>(premultiplied ? std::min<uint32_t>(255, color * 255 / alpha) : color));
    }
    if (has_alpha) image.data.push_back(static_cast<uint8_t>(alpha));
  }
  return ApplyOrientation(std::move(image), TiffOrientation(tiff.get(), orientation));
}

void ReadTiffSize(std::string_view bytes, const std::string& file, Orientation orientation, int* width, int* height) {
  TiffSource source{bytes, 0, ""};
  const Tiff tiff = OpenTiff(&source, file);
  CheckTiffSize(tiff.get(), source, file, width, height);
  if (SwapsAxes(TiffOrientation(tiff.get(), orientation))) std::swap(*width, *height);
}

}  // namespace oraclegs
