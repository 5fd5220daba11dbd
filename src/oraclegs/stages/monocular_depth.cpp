#include "oraclegs/stages/monocular_depth.h"

#include <utility>

#include "oraclegs/core/interrupt.h"
#include "oraclegs/networks/loader.h"
#include "oraclegs/settings/device.h"

namespace oraclegs {

std::vector<RelativeDepth> PredictRelativeDepth(const std::filesystem::path& weights,
                                                const std::vector<LoadedView>& views, const Listener& listener,
                                                Device device) {
  const Networks& networks = GetNetworks();
  const auto network = networks.LoadDepth(weights, DeviceOfNetworks(networks, device, listener));
  std::vector<RelativeDepth> predicted;
  for (const LoadedView& view : views) {
    ThrowIfInterrupted();
    const Buffer<float> map = network->InverseDepth(view.rgb);
    predicted.push_back({view.rgb.width, view.rgb.height, {map.span().begin(), map.span().end()}});
    listener(StepDone{"depth", static_cast<int64_t>(predicted.size()), static_cast<int64_t>(views.size()), "views",
                      "Depth Anything V2"});
  }
  return predicted;
}

bool IsNonCommercialDepthNetwork(const std::string& name) {
  return name.ends_with(" base") || name.ends_with(" large");
}

MonocularMaps WithMonocularDepth(const NetworkDepth& network, const std::vector<LoadedView>& views,
                                 std::vector<DepthMap> stereo, const std::vector<ScenePoint>& points,
                                 const Listener& listener) {
  const std::vector<RelativeDepth>& predicted = network.predicted;
  const bool fused = !stereo.empty();
  std::vector<std::vector<KnownDepth>> known;
  for (size_t v = 0; v < views.size(); ++v) {
    known.push_back(KnownDepths(points, static_cast<int>(v), views[v].camera));
  }
  AlignmentRule rule;
  rule.min_span = MinSpan(known);
  std::vector<Alignment> alignments;
  for (size_t v = 0; v < views.size(); ++v) {
    alignments.push_back(Align(predicted[v], views[v].camera, known[v], rule));
    if (!fused || stereo[v].size() == 0 || alignments[v].scale > 0) continue;
    alignments[v] = Align(predicted[v], views[v].camera, ConfidentDepths(stereo[v]), rule);
  }
  const std::vector<bool> reliable = AreReliable(alignments);
  const Silhouettes silhouettes(views);
  MonocularMaps out;
  std::vector<std::string> unreliable;
  for (size_t v = 0; v < views.size(); ++v) {
    ThrowIfInterrupted();
    const DepthMap frame{views[v].name, views[v].camera, {}, {}, {}};
    if (!reliable[v]) {
      unreliable.push_back(views[v].name);
      // Nothing is known of it: a scale of 0 leaves no inverse depth above 0.
      out.maps.push_back(fused ? std::move(stereo[v]) : AlignedDepth(frame, predicted[v], {}, {}, {}).map);
      continue;
    }
    const AllowedPixels allowed = PixelsWithDepth(views[v], silhouettes, v);
    const auto alone = network.is_whole ? WholeDepth : AlignedDepth;
    MonocularDepth depth = fused && stereo[v].size() > 0
                               ? FusedDepth(stereo[v], predicted[v], alignments[v], known[v], allowed)
                               : alone(frame, predicted[v], alignments[v], known[v], allowed);
    out.right += depth.right / static_cast<double>(views.size());
    out.maps.push_back(std::move(depth.map));
  }
  if (!unreliable.empty()) {
    listener(
        Warning{fmt::format("the network's depth of {} cannot be aligned: too few points are known there, or its "
                            "scale is unlike that of the other views; {}",
                            fmt::join(unreliable, ", "),
                            fused ? "only stereo is used there" : "they have no depth (--depth-prior fused)")});
  }
  return out;
}

}  // namespace oraclegs
