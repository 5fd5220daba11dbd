#pragma once
// Photos that will not register, or spoil the result, are found before an hour is spent on them.

#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/image/image.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// A photo to be checked.
struct CheckedPhoto {
  std::string name;
  std::filesystem::path path;
  bool is_sphere = false;  ///< and is used as one
};

/// The photos of a scene as the user brought them: a sphere, and not its faces, some of which are plain sky.
std::vector<CheckedPhoto> PhotosToCheck(const Scene& scene);

/// Signs of one photo that the checks look at.
struct PhotoSigns {
  double sharpness = 0;                       ///< variance of the Laplacian per variance of the image, at a small size
  double mean = 0;                            ///< gray level, 0 to 255
  double dark = 0, bright = 0;                ///< shares of pixels that are black or white
  double dark_border = 0, bright_border = 0;  ///< and of the pixels at the image's border
  double flat = 0;                            ///< share of pixels equal to their neighbor
  std::vector<double> signature;              ///< 24 x 24 gray levels
  bool is_panorama = false;                   ///< very wide, or said to be one by its metadata
  bool may_be_sphere = false;                 ///< else: by its size, and no camera is named
  int circles = 0;                            ///< image circles of fisheye lenses before black: 0, 1 or 2 side by side
  bool is_screenshot = false;                 ///< a PNG of a phone's screen, without a camera in its metadata
};

/// Decodes a small version. Throws InputError naming the file.
PhotoSigns ReadSigns(const std::filesystem::path& path);

/// A sentence for each kind of trouble, naming the photos and what to do; empty when there is none.
std::vector<std::string> DescribeTrouble(const std::vector<std::string>& names, const std::vector<PhotoSigns>& signs);

/// Trouble that CheckPhotos found.
struct PhotoTrouble {
  std::vector<std::string> warnings;
  std::vector<size_t> unreadable;  ///< indices of photos that cannot be decoded; a warning names each
};

/// Reads the signs of photos without poses and describes the trouble. Reports StepDone{"check"}. Throws InputError
/// naming a photo that cannot be decoded when fewer than three others can.
PhotoTrouble CheckPhotos(const std::vector<CheckedPhoto>& photos, const Listener& listener);

/// Whether photos show something before plain white, as where a program took their background away: the border of the
/// first, the middle and the last is white, and no pixel is transparent. False where one of them cannot be read.
bool AreOnWhite(const std::vector<std::filesystem::path>& photos);

/// Fine detail of a gray image: the variance of its Laplacian (gray levels squared). The blurred one of two images of
/// one scene and size has less. 0 for images below 3 x 3.
double Sharpness(const Image8& gray);

}  // namespace oraclegs
