#include "oraclegs/capture/sharpness.h"

namespace oraclegs {

double Sharpness(const Image8& gray) {
  if (gray.width < 3 || gray.height < 3) return 0;
  const auto width = static_cast<size_t>(gray.width);
  double sum = 0, squares = 0;
  for (size_t y = 1; y + 1 < static_cast<size_t>(gray.height); ++y) {
    const uint8_t* row = gray.data.data() + y * width;
    for (size_t x = 1; x + 1 < width; ++x) {
      const uint8_t* at = row + x;
      const double laplacian = at[-1] + at[1] + *(at - width) + at[width] - 4.0 * at[0];
      sum += laplacian;
      squares += laplacian * laplacian;
    }
  }
  const double count = static_cast<double>((width - 2) * static_cast<size_t>(gray.height - 2));
  return squares / count - (sum / count) * (sum / count);
}

}  // namespace oraclegs
