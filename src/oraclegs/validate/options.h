#pragma once

#include <string>

#include "oraclegs/core/options.h"

namespace oraclegs {

struct ValidateOptions {
  std::string confidence = "consistency";
  std::string pick = "blend";

  template <class V>
  void Visit(V&& visit) {
    visit("confidence", confidence,
          "Who says how far to trust a proposed pixel: consistency = what the photographs show there, calibrated on "
          "hidden photographs; uniform = trust all",
          Choice{{"consistency", "uniform"}});
    visit("pick", pick,
          "What is made of several candidates for a view: blend = their mean, by what their confidence says of their "
          "error; pixel = the surest one at each pixel; view = the surest picture",
          Choice{{"blend", "pixel", "view"}});
  }
};

}  // namespace oraclegs
