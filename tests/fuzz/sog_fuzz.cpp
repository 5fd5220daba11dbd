// SOG: a zip as it is, a folder whose meta.json and means_l.webp are given, or a meta.json followed by the pixels that
// all of its images have.

#include "fuzz/fuzz.h"
#include "oraclegs/formats/codecs.h"
#include "oraclegs/formats/webp.h"
#include "oraclegs/formats/zip_archive.h"

namespace {

using SogFiles = std::vector<std::pair<std::string, std::string>>;

/// Image names in the metas of the corpus.
constexpr const char* kSogNames[] = {"means_l.webp", "means_u.webp",       "quats.webp",      "scales.webp",
                                     "sh0.webp",     "shN_centroids.webp", "shN_labels.webp", "support.webp"};

/// A zip of the meta.json and of images of 4 x 4 pixels, and 192 x 1 for the harmonics.
std::string SogOf(std::string_view meta, std::string_view pixels) {
  SogFiles files = {{"meta.json", std::string(meta)}};
  const auto image = [&](int width, int height) {
    oraclegs::ByteImage made{width, height};
    made.rgba.resize(static_cast<size_t>(4 * width * height), 253);
    for (size_t i = 0; i < made.rgba.size() && !pixels.empty(); ++i) {
      made.rgba[i] = static_cast<uint8_t>(pixels[i % pixels.size()]);
    }
    return oraclegs::EncodeWebp(made);
  };
  static std::string known, square = image(4, 4), row = image(192, 1);  // encoding takes most of the time
  if (known != pixels) known = pixels, square = image(4, 4), row = image(192, 1);
  for (const char* name : kSogNames) {
    files.emplace_back(name, std::string_view(name).starts_with("shN_c") ? row : square);
  }
  return oraclegs::WriteZip(files);
}

}  // namespace

ORACLEGS_FUZZ_TARGET(sog) {
  using namespace oraclegs;
  if (bytes.starts_with("PK")) {
    fuzz::Try([&] { DecodeSog(bytes, "f"); });
    return;
  }
  const auto parts = fuzz::Parts(bytes);
  if (parts[0].starts_with("folder")) {
    static const fuzz::Folder folder;
    folder.Put("meta.json", fuzz::PartAt(parts, 1));
    folder.Put("means_l.webp", fuzz::PartAt(parts, 2));
    fuzz::Try([&] { ReadSogFolder(folder.path()); });
    return;
  }
  const std::string file = SogOf(parts[0], fuzz::PartAt(parts, 1));
  fuzz::Try([&] { DecodeSog(file, "f"); });
}
