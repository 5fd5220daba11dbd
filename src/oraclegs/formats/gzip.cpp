#include "oraclegs/formats/gzip.h"

#define ZLIB_CONST  // zlib then takes its input as const
#include <zlib.h>

#include <algorithm>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

constexpr int kGzipWindow = 15 + 16;            // the largest window, and gzip's header
constexpr size_t kGzipStep = size_t{1} << 20;   // bytes asked of zlib at once
constexpr size_t kZlibLimit = size_t{1} << 30;  // zlib counts in 32 bits

Bytef* ZlibBytes(char* data) { return reinterpret_cast<Bytef*>(data); }
const Bytef* ZlibBytes(const char* data) { return reinterpret_cast<const Bytef*>(data); }

}  // namespace

std::string Gzip(std::string_view bytes) {
  z_stream stream{};
  if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, kGzipWindow, 9, Z_DEFAULT_STRATEGY) != Z_OK) {
    throw OutOfMemory("zlib: no memory to compress {} bytes", bytes.size());
  }
  std::string packed, piece(kGzipStep, '\0');
  int state = Z_OK;
  size_t read = 0;
  while (state != Z_STREAM_END) {
    if (stream.avail_in == 0 && read < bytes.size()) {
      const size_t step = std::min(bytes.size() - read, kZlibLimit);
      stream.next_in = ZlibBytes(bytes.data() + read);
      stream.avail_in = static_cast<uInt>(step);
      read += step;
    }
    stream.next_out = ZlibBytes(piece.data());
    stream.avail_out = kGzipStep;
    state = deflate(&stream, read == bytes.size() ? Z_FINISH : Z_NO_FLUSH);
    packed.append(piece.data(), kGzipStep - stream.avail_out);
  }
  deflateEnd(&stream);
  return packed;
}

struct Gunzip::Stream {
  Stream() = default;
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
  ~Stream() { inflateEnd(&zlib); }

  z_stream zlib{};
  std::string_view rest;  // what zlib was not given yet
  bool ended = false;
};

Gunzip::Gunzip(std::string_view bytes, std::string file) : file_(std::move(file)) {
  if (bytes.size() < 2 || bytes[0] != '\x1f' || bytes[1] != '\x8b') {
    throw InputError("{}: is not compressed by gzip; the file is damaged or of another format", file_);
  }
  stream_ = std::make_unique<Stream>();
  stream_->rest = bytes;
  if (inflateInit2(&stream_->zlib, kGzipWindow) != Z_OK) throw OutOfMemory("{}: no memory to unpack it", file_);
}

Gunzip::~Gunzip() = default;

std::string Gunzip::Next(uint64_t count) {
  z_stream& zlib = stream_->zlib;
  std::string out, piece(std::min<uint64_t>(count, kGzipStep), '\0');
  while (out.size() < count && !stream_->ended) {
    if (zlib.avail_in == 0) {
      const size_t step = std::min(stream_->rest.size(), kZlibLimit);
      zlib.next_in = ZlibBytes(stream_->rest.data());
      zlib.avail_in = static_cast<uInt>(step);
      stream_->rest.remove_prefix(step);
    }
    const size_t step = std::min<uint64_t>(count - out.size(), kGzipStep);
    zlib.next_out = ZlibBytes(piece.data());
    zlib.avail_out = static_cast<uInt>(step);
    const int state = inflate(&zlib, Z_NO_FLUSH);
    out.append(piece.data(), step - zlib.avail_out);
    stream_->ended = state == Z_STREAM_END;
    if (state == Z_MEM_ERROR) throw OutOfMemory("{}: no memory to unpack it", file_);
    if (state != Z_OK && state != Z_STREAM_END) {
      throw InputError("{}: its gzip data are damaged or cut short; copy or export it again", file_);
    }
  }
  return out;
}

}  // namespace oraclegs
