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

/// Rule that makes one image of several candidates.
enum class PickRule {
  kBlend,  ///< at each pixel the mean, weighted by the inverse of the squared error that the confidence implies
  kPixel,  ///< at each pixel the candidate of highest confidence
  kView,   ///< the candidate of highest mean confidence
};
template <>
struct EnumWords<PickRule> {
  static constexpr EnumWord<PickRule> kWords[] = {
      {PickRule::kBlend, "blend"}, {PickRule::kPixel, "pixel"}, {PickRule::kView, "view"}};
};

/// Images that VGGT looks at in one pass.
enum class OraclePass {
  kChunk,  ///< a few proposals beside the nearest image, as the paper says
  kAll,    ///< images and proposals in random order, as its authors' code does
};
template <>
struct EnumWords<OraclePass> {
  static constexpr EnumWord<OraclePass> kWords[] = {{OraclePass::kChunk, "chunk"}, {OraclePass::kAll, "all"}};
};

struct ValidateOptions {
  Auto<OracleKind> oracle;
  AttentionMode oracle_mode = AttentionMode::kReference;
  OraclePass oracle_pass = OraclePass::kChunk;
  Auto<int> oracle_chunk;
  Auto<VggtPrecision> vggt_precision;
  std::string vggt_layers;         ///< see AttentionLayersOf
  std::string vggt_layer_weights;  ///< see AttentionLayersOf
  bool calibrate = true;
  PickRule pick = PickRule::kBlend;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("oracle", self.oracle,
          "What estimates the confidence of proposed pixels: consistency = multi-view consistency with the photos; "
          "vggt = cross-view attention of the network VGGT; vggt+consistency = both; uniform = 1 everywhere; auto = "
          "vggt+consistency where VGGT's weights are, else consistency");
    visit("oracle-mode", self.oracle_mode,
          "Which attention of VGGT is used as confidence: reference = of the photo beside the proposals; others = of "
          "all other views of the pass; official = of the photo's camera token, over the whole pass together, as in "
          "the paper's code",
          Tier::kSetting);
    visit("oracle-pass", self.oracle_pass,
          "What VGGT looks at in one pass: chunk = a few proposals beside the nearest photo, as the paper says; all = "
          "all photos and proposals in an order that depends on --seed, the first of each pass its reference, as the "
          "paper's code does (with --oracle vggt, oracle-mode=official and calibrate=false)",
          Tier::kSetting);
    visit("oracle-chunk", self.oracle_chunk,
          "Proposals that VGGT processes together, beside one photo; auto = 8, or as many as fit into memory; 0 = all, "
          "or as many as fit; with oracle-pass=all the images of a pass, auto = 96, or as many as fit",
          Range{0, 512}, Tier::kSetting);
    visit("vggt-precision", self.vggt_precision,
          "Number type of VGGT as oracle: float32; bfloat16; autocast = as its authors run it: weights and sums in "
          "float32, products in bfloat16; auto = bfloat16 on a GPU, else float32",
          Tier::kSetting);
    visit("vggt-layers", self.vggt_layers,
          "Layers of VGGT's global attention that make the confidence, from 0, comma-separated; without, 0,22 with the "
          "weights 1,3, or what the file of weights names",
          Tier::kSetting);
    visit("vggt-layer-weights", self.vggt_layer_weights,
          "Weights of --set vggt-layers, comma-separated; scaled to sum to 1; without, all the same", Tier::kSetting);
    visit("calibrate", self.calibrate,
          "Calibrate the confidence on held-out training photos; --set calibrate=false takes VGGT's attention as it "
          "is, as in "
          "the paper, and the uncalibrated score of the other oracles",
          Tier::kSetting);
    visit("pick", self.pick,
          "How several candidates for a view are fused: blend = mean weighted by confidence; pixel = the most "
          "confident candidate at each pixel; view = the candidate of highest mean confidence",
          Tier::kSetting);
  }
};

}  // namespace oraclegs
