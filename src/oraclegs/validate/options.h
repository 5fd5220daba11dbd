#pragma once

#include <string>

#include "oraclegs/core/options.h"
#include "oraclegs/networks/networks.h"

namespace oraclegs {

enum class OracleKind { kConsistency, kVggt, kVggtAndConsistency, kUniform };
template <>
struct EnumWords<OracleKind> {
  static constexpr EnumWord<OracleKind> kWords[] = {{OracleKind::kConsistency, "consistency"},
                                                    {OracleKind::kVggt, "vggt"},
                                                    {OracleKind::kVggtAndConsistency, "vggt+consistency"},
                                                    {OracleKind::kUniform, "uniform"}};
};

/// One image out of several candidates.
enum class PickRule {
  kBlend,  ///< at each pixel the mean, weighted by the inverse of the squared error that the confidence stands for
  kPixel,  ///< at each pixel the candidate of highest confidence
  kView,   ///< the candidate of highest mean confidence
};
template <>
struct EnumWords<PickRule> {
  static constexpr EnumWord<PickRule> kWords[] = {
      {PickRule::kBlend, "blend"}, {PickRule::kPixel, "pixel"}, {PickRule::kView, "view"}};
};

struct ValidateOptions {
  Auto<OracleKind> oracle;
  AttentionMode oracle_mode = AttentionMode::kReference;
  Auto<int> oracle_chunk;
  Auto<VggtPrecision> vggt_precision;
  std::string vggt_layers;         ///< see AttentionLayersOf
  std::string vggt_layer_weights;  ///< likewise
  bool calibrate = true;
  PickRule pick = PickRule::kBlend;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("oracle", self.oracle,
          "What decides how far a proposed pixel is trusted: consistency = what the images show there; vggt = what the "
          "views attend to in each other inside VGGT; vggt+consistency = both; uniform = trust all; auto = "
          "vggt+consistency where VGGT's weights are, else consistency");
    visit("oracle-mode", self.oracle_mode,
          "Whose attention VGGT's map is made of: reference = that of the image beside the proposals; others = that of "
          "all other views of the pass; official = that of the image's camera token, over the whole pass together");
    visit("oracle-chunk", self.oracle_chunk,
          "Proposals that VGGT looks at together, beside one image; auto = 8, or as many as the free memory holds; 0 = "
          "all "
          "of them, or as many as the free memory holds",
          Range{0, 512});
    visit("vggt-precision", self.vggt_precision,
          "Number type of VGGT as oracle: float32; bfloat16; autocast = as its authors run it: weights and sums in "
          "float32, "
          "products in bfloat16; auto = bfloat16 on a GPU, else float32");
    visit("vggt-layers", self.vggt_layers,
          "Layers of VGGT's global attention that its map is made of, from 0, comma-separated; without, 0,22 with the "
          "weights 1,3, or what the file of weights names");
    visit("vggt-layer-weights", self.vggt_layer_weights,
          "How much each of --vggt-layers counts, comma-separated; scaled to sum to 1; without, all count alike");
    visit("calibrate", self.calibrate,
          "Map what the oracle predicts to what such pixels were worth in held-out views; without, VGGT's map is used "
          "as it is, as in the paper, and of the others the order that they learnt");
    visit("pick", self.pick,
          "What several candidates for a view become: blend = their mean, weighted by the error that their confidence "
          "stands for; pixel = the candidate of highest confidence at each pixel; view = the one of highest mean "
          "confidence");
  }
};

}  // namespace oraclegs
