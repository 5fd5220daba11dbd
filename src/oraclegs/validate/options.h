#pragma once

#include <string>

#include "oraclegs/core/options.h"

namespace oraclegs {

struct ValidateOptions {
  std::string oracle = "auto";
  std::string oracle_mode = "reference";
  int oracle_chunk = 0;
  bool calibrate = true;
  std::string pick = "blend";

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("oracle", self.oracle,
          "Who says how far to trust a proposed pixel: consistency = what the photographs show there; vggt = what the "
          "views look at in each other inside VGGT; vggt+consistency = both. "
          "uniform = trust all; auto = vggt+consistency where VGGT's weights are, else consistency",
          Choice{{"auto", "consistency", "vggt", "vggt+consistency", "uniform"}});
    visit("oracle-mode", self.oracle_mode,
          "Whose attention VGGT counts: reference = that of the photograph beside the proposals; others = that of all "
          "other views of the pass; official = that of the photograph's camera token, over the whole pass together",
          Choice{{"official", "reference", "others"}});
    visit("oracle-chunk", self.oracle_chunk,
          "Proposals that VGGT looks at together, beside one photograph; 0 = 8, or as many as the free memory holds",
          Range{0, 512});
    visit("calibrate", self.calibrate,
          "Map what the oracle says to what such pixels were worth where photographs were hidden; without, VGGT's map "
          "counts as it is, as in the paper, and of the others the order that they learnt");
    visit("pick", self.pick,
          "What is made of several candidates for a view: blend = their mean, by what their confidence says of their "
          "error; pixel = the surest one at each pixel; view = the surest picture",
          Choice{{"blend", "pixel", "view"}});
  }
};

}  // namespace oraclegs
