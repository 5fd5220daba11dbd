// gzip and zip as the formats of splats use them, and zip archives of photos.

#include "fuzz/fuzz.h"
#include "oraclegs/capture/zip_photos.h"
#include "oraclegs/formats/gzip.h"
#include "oraclegs/formats/zip_archive.h"

ORACLEGS_FUZZ_TARGET(archives) {
  using namespace oraclegs;
  if (!bytes.starts_with("PK")) {
    fuzz::Try([&] {
      Gunzip unpacked(bytes, "f");
      unpacked.Next(16);
      unpacked.Next(1 << 20);
    });
    return;
  }
  fuzz::Try([&] { ReadZip(bytes, 64, "f"); });
  static const fuzz::Folder folder;
  const auto archive = folder.Put("a.zip", bytes);
  fuzz::Try([&] {
    if (!IsZip(archive) || CountZipPhotos(archive) == 0) return;
    UnpackPhotos(archive, folder.path() / "photos", Silent());
  });
  std::error_code ignored;
  std::filesystem::remove_all(folder.path() / "photos", ignored);
}
