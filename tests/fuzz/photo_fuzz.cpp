// An image file of any kind, by its content, as a scene of photos reads it.

#include "fuzz/fuzz.h"
#include "fuzz/images.h"
#include "oraclegs/image/read_image.h"

ORACLEGS_FUZZ_TARGET(photo) {
  using namespace oraclegs;
  static const fuzz::Folder folder;
  const auto path = folder.Put("a.jpg", bytes);
  fuzz::Try([&] { ReadImageInfo(path); });
  if (!fuzz::IsSmall([&](int* width, int* height) { ReadImageSize(path, width, height); })) return;
  fuzz::Try([&] { ReadImage(path, Orientation::kAsStored); });
  fuzz::Try([&] { ReadGrayThumbnail(path, 8); });
}
