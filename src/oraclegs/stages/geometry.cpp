#include "oraclegs/stages/geometry.h"

#include "oraclegs/depth/gains.h"

namespace oraclegs {

bool Geometry::HasVariedExposure() const { return ExposureSpread(gains) > kVariedExposure; }

FusionOptions FusionOf(const std::vector<Eigen::Vector3f>& gains) {
  FusionOptions options;
  if (ExposureSpread(gains) > kVariedExposure) options.gains = gains;
  return options;
}

}  // namespace oraclegs
