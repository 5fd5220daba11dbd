#pragma once
// The notes of a camera beside the pixels, and where each kind of image file keeps them.

#include <optional>
#include <string>
#include <string_view>

#include "oraclegs/image/image.h"

namespace oraclegs {

/// Where a photo was taken (WGS 84).
struct GpsPosition {
  double latitude = 0, longitude = 0;  ///< degrees, north and east positive
  std::optional<double> altitude;      ///< meters above sea level
};

/// The notes of a camera; 0 or empty where unknown. Texts are printable ASCII.
struct Exif {
  int orientation = 1;                    ///< tag 0x0112: 1 to 8, 1 = upright
  double focal_mm = 0;                    ///< focal length of the lens, millimeters
  double focal_35mm = 0;                  ///< focal length with the same angle of view on 36 mm x 24 mm
  double pixels_per_mm = 0;               ///< on the sensor, along the image's width
  int pixel_width = 0, pixel_height = 0;  ///< size of the image as the camera wrote it, unturned
  std::string make, model;                ///< maker and model of the camera
  std::string date;                       ///< when taken: "2026:11:23 10:00:00"
  std::optional<GpsPosition> gps;

  bool HasCamera() const { return !make.empty() || !model.empty() || focal_mm > 0 || focal_35mm > 0; }
};

/// Reads a TIFF structure ("II*" or "MM*"), the form of every EXIF block. Damage there is no error: what cannot be read
/// keeps its default, and nothing outside of `tiff` is read.
Exif ParseExif(std::string_view tiff);

/// The EXIF of a JPEG (APP1), PNG (eXIf), WebP (EXIF), TIFF or HEIF file.
Exif ReadExif(std::string_view file);

/// The focal length in pixels of an image of this size that was made by only scaling what the camera wrote; nothing
/// when the tags do not say it or what they say is no lens (a field of view below 4 or above 150 degrees).
std::optional<double> FocalPixels(const Exif& exif, int width, int height);

// The application segments of a JPEG, as far as they are about its pixels: orientation, and inverted CMYK.

struct JpegMetadata {
  int orientation = 1;          ///< EXIF tag 0x0112: 1 to 8, 1 = upright
  bool has_adobe_mark = false;  ///< an APP14 "Adobe" segment: CMYK is stored inverted
};

/// Reads the segments before the first scan. Damage there is no error: what cannot be read keeps its default.
JpegMetadata ReadJpegMetadata(std::string_view jpeg);

/// True when the orientation swaps width and height.
bool SwapsAxes(int orientation);

/// Turns and mirrors a stored image so that it stands upright.
Image8 ApplyOrientation(Image8 image, int orientation);

}  // namespace oraclegs
