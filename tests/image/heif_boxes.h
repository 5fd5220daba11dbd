#pragma once
// HEIF files that no program writes, box by box.

#include <string>

#include "image/photo_files.h"

namespace oraclegs {

/// Big-endian.
inline std::string HeifNumber(uint64_t value, int bytes) {
  const std::string little = ExifMaker::Number(value, bytes);
  return {little.rbegin(), little.rend()};
}

inline std::string HeifBox(const std::string& type, const std::string& body) {
  return HeifNumber(8 + body.size(), 4) + type + body;
}

/// References between images: "dimg" is made of, "auxl" belongs to.
inline std::string HeifReference(const std::string& type, uint64_t from, const std::vector<uint64_t>& to) {
  std::string body = HeifNumber(from, 2) + HeifNumber(to.size(), 2);
  for (const uint64_t id : to) body += HeifNumber(id, 2);
  return HeifBox(type, body);
}

/// The main image is 2, a grid of 16 x 8 pixels; 1 is an overlay with a canvas of this size.
inline std::string GridFile(uint64_t width, uint64_t height, const std::string& references) {
  const std::string zero = HeifNumber(0, 4), start = HeifBox("ftyp", "heic" + zero + "heic");
  const auto n = HeifNumber;
  const auto item = [&](uint64_t id, const std::string& type) {
    return HeifBox("infe", n(0x02000000, 4) + n(id, 2) + n(0, 2) + type + '\0');
  };
  const auto meta = [&](uint64_t overlay_at) {
    const std::string places = n(0x0100000044400002, 8) + n(1, 2) + zero + n(overlay_at, 4) + n(1, 2) + zero +
                               n(14, 4) + n(2, 2) + n(1, 2) + n(0, 2) + zero + n(1, 2) + zero + n(8, 4);
    const std::string properties =
        HeifBox("ipco", HeifBox("ispe", zero + n(16, 4) + n(8, 4)) + HeifBox("pixi", zero + "\3\10\10\10")) +
        HeifBox("ipma", zero + n(2, 4) + n(1, 2) + "\2\1\2" + n(2, 2) + "\2\1\2");
    return HeifBox("meta", zero + HeifBox("hdlr", zero + zero + "pict" + std::string(13, '\0')) +
                               HeifBox("pitm", zero + n(2, 2)) + HeifBox("idat", zero + n(16, 2) + n(8, 2)) +
                               HeifBox("iloc", places) +
                               HeifBox("iinf", zero + n(2, 2) + item(1, "iovl") + item(2, "grid")) +
                               HeifBox("iprp", properties) + HeifBox("iref", zero + references));
  };
  const std::string overlay = std::string(10, '\0') + n(width, 2) + n(height, 2);
  return start + meta(start.size() + meta(0).size() + 8) + HeifBox("mdat", overlay);
}

}  // namespace oraclegs
