// libpng reports errors by longjmp. Each call into it therefore stands in a function without objects that have
// destructors (RunRead, RunWrite); what they own lives in the caller.
#include "oraclegs/image/codecs.h"

#include <png.h>

#include <algorithm>
#include <csetjmp>
#include <cstring>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"

namespace oraclegs {
namespace {

constexpr std::string_view kSignature("\x89PNG\r\n\x1a\n", 8);
constexpr size_t kSizeAt = 16;  // width and height stand behind the signature and the first chunk's head
constexpr size_t kDepthAt = 24, kColorAt = 25;
constexpr int kCompression = 4;  // of zlib's 1 to 9: 2.6 times as fast as the usual 6, for files 2 % larger
constexpr uint64_t kPngPixelsPerByte = 8 * 1032;  // deflate packs 1032 to 1 at most, a byte is eight pixels at most

struct ErrorText {
  char text[160] = "";
};

[[noreturn]] void OnError(png_structp png, png_const_charp message) {
  auto* error = static_cast<ErrorText*>(png_get_error_ptr(png));
  std::strncpy(error->text, message, sizeof(error->text) - 1);
  png_longjmp(png, 1);
}

void OnWarning(png_structp, png_const_charp) {}

struct ReadState {
  explicit ReadState(std::string_view input) : bytes(input) {
    png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &error, OnError, OnWarning);
    if (png != nullptr) info = png_create_info_struct(png);
  }
  ~ReadState() { png_destroy_read_struct(&png, &info, nullptr); }
  ReadState(const ReadState&) = delete;
  ReadState& operator=(const ReadState&) = delete;

  std::string_view bytes;
  size_t at = 0;
  bool as_stored = false;
  ErrorText error;
  png_structp png = nullptr;
  png_infop info = nullptr;
};

void OnRead(png_structp png, png_bytep target, size_t count) {
  auto* state = static_cast<ReadState*>(png_get_io_ptr(png));
  if (state->bytes.size() - state->at < count) png_error(png, "the file ends too early");
  std::memcpy(target, state->bytes.data() + state->at, count);
  state->at += count;
}

/// Up to the pixels; from then on rows are 8-bit RGB or RGBA, or as stored.
void StartRead(ReadState* state) {
  png_set_read_fn(state->png, state, OnRead);
  png_set_user_limits(state->png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);  // CheckImageSize has looked
  // Chunks that are not of the pixels are passed over: for some of them libpng takes the memory that their length asks
  // for.
  png_set_keep_unknown_chunks(state->png, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
  png_read_info(state->png, state->info);
  if (state->as_stored) return;
  png_set_expand(state->png);
  png_set_scale_16(state->png);
  png_set_gray_to_rgb(state->png);
  png_set_interlace_handling(state->png);
  png_read_update_info(state->png, state->info);
}

void FinishRead(ReadState* state, png_bytepp rows) {
  png_read_image(state->png, rows);
  png_read_end(state->png, nullptr);
}

/// Starts reading when `rows` is null, else fills them. False: state->error says why.
bool RunRead(ReadState* state, png_bytepp rows) {
  if (setjmp(png_jmpbuf(state->png)) != 0) return false;
  if (rows == nullptr) {
    StartRead(state);
  } else {
    FinishRead(state, rows);
  }
  return true;
}

struct WriteState {
  WriteState() {
    png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &error, OnError, OnWarning);
    if (png != nullptr) info = png_create_info_struct(png);
  }
  ~WriteState() { png_destroy_write_struct(&png, &info); }
  WriteState(const WriteState&) = delete;
  WriteState& operator=(const WriteState&) = delete;

  std::string bytes;
  ErrorText error;
  png_structp png = nullptr;
  png_infop info = nullptr;
};

bool Append(std::string* bytes, png_bytep data, size_t count) {
  try {
    bytes->append(reinterpret_cast<const char*>(data), count);
  } catch (const std::exception&) {
    return false;
  }
  return true;
}

void OnWrite(png_structp png, png_bytep data, size_t count) {
  if (!Append(&static_cast<WriteState*>(png_get_io_ptr(png))->bytes, data, count)) png_error(png, "out of memory");
}

void OnFlush(png_structp) {}

struct Layout {
  int width = 0, height = 0, depth = 8, color = PNG_COLOR_TYPE_RGB;
};

/// Rows of `row_bytes` follow one another from `data`.
bool RunWrite(WriteState* state, const Layout& layout, const uint8_t* data, size_t row_bytes) {
  if (setjmp(png_jmpbuf(state->png)) != 0) return false;
  png_set_write_fn(state->png, state, OnWrite, OnFlush);
  png_set_compression_level(state->png, kCompression);
  png_set_IHDR(state->png, state->info, static_cast<png_uint_32>(layout.width), static_cast<png_uint_32>(layout.height),
               layout.depth, layout.color, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(state->png, state->info);
  for (int y = 0; y < layout.height; ++y) png_write_row(state->png, data + static_cast<size_t>(y) * row_bytes);
  png_write_end(state->png, nullptr);
  return true;
}

/// Rows follow one another from `data`.
std::vector<png_bytep> RowPointers(uint8_t* data, int height, size_t row_bytes) {
  std::vector<png_bytep> rows(static_cast<size_t>(height));
  for (size_t y = 0; y < rows.size(); ++y) rows[y] = data + y * row_bytes;
  return rows;
}

void Write(const std::filesystem::path& path, const Layout& layout, const std::vector<uint8_t>& data) {
  WriteState state;
  if (state.info == nullptr) throw RunError("{}: cannot be written: the PNG encoder cannot start", path.string());
  if (!RunWrite(&state, layout, data.data(), data.size() / static_cast<size_t>(layout.height))) {
    throw RunError("{}: cannot be written: {}", path.string(), state.error.text);
  }
  WriteFileAtomically(path, state.bytes);
}

int ColorType(const std::filesystem::path& path, int channels) {
  if (channels == 1) return PNG_COLOR_TYPE_GRAY;
  if (channels == 3) return PNG_COLOR_TYPE_RGB;
  if (channels == 4) return PNG_COLOR_TYPE_RGB_ALPHA;
  throw ShapeError("WritePng {}: {} channels, expected 1, 3 or 4", path.string(), channels);
}

void CheckPixels(const std::filesystem::path& path, const Layout& layout, int channels, size_t values) {
  const bool fits =
      layout.width > 0 && layout.height > 0 &&
      values == static_cast<size_t>(layout.width) * static_cast<size_t>(layout.height) * static_cast<size_t>(channels);
  if (!fits) {
    throw ShapeError("WritePng {}: {} values do not make {} x {} x {}", path.string(), values, layout.height,
                     layout.width, channels);
  }
}

}  // namespace

bool IsPng(std::string_view bytes) { return bytes.starts_with(kSignature); }

int PngGrayBits(std::string_view head) {
  const bool gray = IsPng(head) && head.size() > kColorAt && head[kColorAt] == PNG_COLOR_TYPE_GRAY;
  return gray ? head[kDepthAt] : 0;
}

bool PngMayBeTransparent(std::string_view head) {
  if (!IsPng(head) || head.size() <= kColorAt) return false;
  const auto color = static_cast<unsigned char>(head[kColorAt]);
  return color == PNG_COLOR_TYPE_PALETTE || (color & PNG_COLOR_MASK_ALPHA) != 0;
}

void ReadPngSize(std::string_view bytes, const std::string& file, int* width, int* height) {
  if (bytes.size() < kPngHeaderBytes || bytes.substr(12, 4) != "IHDR") {
    throw InputError("{}: is a damaged PNG (no header); copy or export it again", file);
  }
  const auto number = [&bytes](size_t at) {
    int64_t value = 0;
    for (size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
    return value;
  };
  const int64_t w = number(kSizeAt), h = number(kSizeAt + 4);
  CheckImageSize(w, h, bytes.size() * kPngPixelsPerByte, file);
  *width = static_cast<int>(w);
  *height = static_cast<int>(h);
}

Image8 DecodePng(std::string_view bytes, const std::string& file) {
  Image8 image;
  ReadPngSize(bytes, file, &image.width, &image.height);
  ReadState state(bytes);
  if (state.info == nullptr) throw RunError("{}: the PNG decoder cannot start", file);
  const auto check = [&](bool ok) {
    if (!ok) {
      throw InputError("{}: is a damaged or incomplete PNG ({}); copy or export it again", file, state.error.text);
    }
  };
  check(RunRead(&state, nullptr));
  image.channels = png_get_channels(state.png, state.info);
  const size_t row_bytes = static_cast<size_t>(image.width) * static_cast<size_t>(image.channels);
  if (png_get_rowbytes(state.png, state.info) != row_bytes) throw InputError("{}: is a PNG of unknown layout", file);
  image.data.resize(row_bytes * static_cast<size_t>(image.height));
  auto rows = RowPointers(image.data.data(), image.height, row_bytes);
  check(RunRead(&state, rows.data()));
  return image;
}

Image16 ReadPng16(const std::filesystem::path& path) {
  const std::string bytes = ReadFile(path);
  const std::string file = path.string();
  if (!IsPng(bytes)) throw InputError("{}: is no PNG; remove it, and it is made again", file);
  Image16 image;
  ReadPngSize(bytes, file, &image.width, &image.height);
  ReadState state(bytes);
  state.as_stored = true;
  if (state.info == nullptr) throw RunError("{}: the PNG decoder cannot start", file);
  const auto check = [&](bool ok) {
    if (!ok) throw InputError("{}: is a damaged or incomplete PNG ({}); make it again", file, state.error.text);
  };
  check(RunRead(&state, nullptr));
  const size_t row_bytes = 2 * static_cast<size_t>(image.width);
  if (png_get_bit_depth(state.png, state.info) != 16 || png_get_rowbytes(state.png, state.info) != row_bytes ||
      png_get_interlace_type(state.png, state.info) != PNG_INTERLACE_NONE) {
    throw InputError("{}: is not a gray PNG of 16 bits, as depth maps are; export it so", file);
  }
  std::vector<uint8_t> data(row_bytes * static_cast<size_t>(image.height));
  auto rows = RowPointers(data.data(), image.height, row_bytes);
  check(RunRead(&state, rows.data()));
  image.values.resize(data.size() / 2);  // PNG is big-endian
  for (size_t i = 0; i < image.values.size(); ++i) {
    image.values[i] = static_cast<uint16_t>(data[2 * i] << 8 | data[2 * i + 1]);
  }
  return image;
}

void WritePng(const std::filesystem::path& path, const Image8& image) {
  const Layout layout{image.width, image.height, 8, ColorType(path, image.channels)};
  CheckPixels(path, layout, image.channels, image.data.size());
  Write(path, layout, image.data);
}

void WritePng16(const std::filesystem::path& path, int width, int height, const std::vector<uint16_t>& values) {
  const Layout layout{width, height, 16, PNG_COLOR_TYPE_GRAY};
  CheckPixels(path, layout, 1, values.size());
  std::vector<uint8_t> data;  // PNG is big-endian
  data.reserve(values.size() * 2);
  for (const uint16_t value : values) {
    data.push_back(static_cast<uint8_t>(value >> 8));
    data.push_back(static_cast<uint8_t>(value & 255));
  }
  Write(path, layout, data);
}

}  // namespace oraclegs
