#include "oraclegs/pipeline/stages/monocular_stage.h"

#include <utility>

#include "oraclegs/core/interrupt.h"
#include "oraclegs/depth/silhouettes.h"
#include "oraclegs/evaluate/evaluate.h"
#include "oraclegs/networks/common/recognize.h"

namespace oraclegs {
namespace {

/// Where a photograph's mask and its object's silhouette let anything be.
AllowedPixels Allowed(const LoadedView& photo, const Silhouettes& silhouettes, size_t v) {
  AllowedPixels allowed = photo.mask;
  if (silhouettes.empty()) return allowed;
  const std::vector<uint8_t>& object = silhouettes.Object(v);
  if (allowed.empty()) return object;
  for (size_t i = 0; i < allowed.size(); ++i) allowed[i] = allowed[i] != 0 && object[i] != 0 ? 1 : 0;
  return allowed;
}

}  // namespace

std::vector<RelativeDepth> GuessDepth(const std::filesystem::path& weights, const std::vector<LoadedView>& photos,
                                      const Listener& listener, torch::Device device) {
  const DepthAnything model = LoadRecognizedDepthAnything(weights, device);
  std::vector<RelativeDepth> guesses;
  for (const LoadedView& photo : photos) {
    ThrowIfInterrupted();
    const Tensor map = RelativeInverseDepth(model, ToTensor(photo.rgb));
    const float* values = map.data_ptr<float>();
    guesses.push_back({photo.rgb.width, photo.rgb.height, {values, values + map.numel()}});
    listener(StepDone{"depth", static_cast<int64_t>(guesses.size()), static_cast<int64_t>(photos.size()), "photographs",
                      "Depth Anything V2"});
  }
  return guesses;
}

std::string DepthNetworkName(const std::filesystem::path& weights) {
  const int64_t width = RecognizeDepthAnything(weights).backbone.width;
  for (const auto& [size, word] :
       {std::pair{DepthAnythingSize::kSmall, "small"}, std::pair{DepthAnythingSize::kBase, "base"},
        std::pair{DepthAnythingSize::kLarge, "large"}}) {
    if (width == DepthAnythingV2(size).backbone.width) return std::string("Depth Anything V2 ") + word;
  }
  return "Depth Anything V2 of another size";
}

bool IsNonCommercialDepthNetwork(const std::string& name) {
  return name.ends_with(" base") || name.ends_with(" large");
}

MonocularMaps WithMonocularDepth(const std::vector<RelativeDepth>& guesses, const std::vector<LoadedView>& photos,
                                 std::vector<DepthMap> stereo, const std::vector<ScenePoint>& points,
                                 const Listener& listener) {
  const bool fused = !stereo.empty();
  std::vector<std::vector<KnownDepth>> known;
  for (size_t v = 0; v < photos.size(); ++v) {
    known.push_back(KnownDepths(points, static_cast<int>(v), photos[v].camera));
  }
  AlignmentRule rule;
  rule.smallest_span = SmallestSpan(known);
  std::vector<Alignment> alignments;
  for (size_t v = 0; v < photos.size(); ++v) {
    alignments.push_back(Align(guesses[v], photos[v].camera, known[v], rule));
    if (!fused || alignments[v].scale > 0) continue;
    alignments[v] = Align(guesses[v], photos[v].camera, ConfidentDepths(stereo[v]), rule);
  }
  const std::vector<bool> reliable = AreReliable(alignments);
  const Silhouettes silhouettes(photos);
  MonocularMaps out;
  std::vector<std::string> unreliable;
  for (size_t v = 0; v < photos.size(); ++v) {
    ThrowIfInterrupted();
    const DepthMap frame{photos[v].name, photos[v].camera, {}, {}, {}};
    if (!reliable[v]) {
      unreliable.push_back(photos[v].name);
      // Nothing is known of it: a scale of 0 leaves no inverse depth above 0.
      out.maps.push_back(fused ? std::move(stereo[v]) : AlignedDepth(frame, guesses[v], {}, {}, {}).map);
      continue;
    }
    const AllowedPixels allowed = Allowed(photos[v], silhouettes, v);
    MonocularDepth depth = fused ? FusedDepth(stereo[v], guesses[v], alignments[v], known[v], allowed)
                                 : AlignedDepth(frame, guesses[v], alignments[v], known[v], allowed);
    out.right += depth.right / static_cast<double>(photos.size());
    out.maps.push_back(std::move(depth.map));
  }
  if (!unreliable.empty()) {
    listener(
        Warning{fmt::format("the network's depth of {} cannot be aligned: too few points are known there, or its "
                            "scale is unlike the other photographs'; {}",
                            fmt::join(unreliable, ", "),
                            fused ? "stereo stands alone there" : "they have no depth (--depth-prior fused)")});
  }
  return out;
}

}  // namespace oraclegs
