#pragma once

namespace oraclegs {

/// How a warped pixel is known.
struct PixelEvidence {
  float support = 0;     ///< sum over the views that show the point of (0.1 + confidence), nearer ones more
  float views = 0;       ///< how many show it
  float angle = 90;      ///< degrees between the ray and that of the nearest view that shows the point; 90 = none
  float spread = 0;      ///< RMS difference of the views' colours there
  float confidence = 0;  ///< of the depth, in the most confident view
  float conflicts = 0;   ///< summed confidence of views that look through the point
  float occluded = 0;    ///< summed confidence of views in which something stands before it
  float ring = 0;        ///< pixels to the nearest one whose depth was warped, 0 for those
  float resolution = 0;  ///< pixels of the best view in one pixel, per axis, at most 1
  float background = 0;  ///< 1 = the ray misses the object
};

}  // namespace oraclegs
