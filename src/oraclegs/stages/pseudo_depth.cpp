#include "oraclegs/stages/pseudo_depth.h"

#include <memory>
#include <utility>

#include "oraclegs/networks/loader.h"
#include "oraclegs/propose/warp.h"
#include "oraclegs/settings/device.h"

namespace oraclegs {
namespace {

/// A warper with what it refers to.
struct OwnWarper {
  OwnWarper(std::vector<LoadedView> loaded, std::vector<DepthMap> of_views)
      : views(std::move(loaded)),
        maps(std::move(of_views)),
        silhouettes(views),
        warper(WarpSources{views, maps, {}, &silhouettes}) {}

  std::vector<LoadedView> views;
  std::vector<DepthMap> maps;
  Silhouettes silhouettes;
  Warper warper;
};

}  // namespace

PseudoDepth NetworkPseudoDepth(const std::filesystem::path& weights, Device device, const Listener& listener) {
  const Networks& networks = GetNetworks();
  const std::shared_ptr<const DepthNetwork> network =
      networks.LoadDepth(weights, DeviceOfNetworks(networks, device, listener));
  return [network](const Camera&, const Buffer<float>& image, const CompareDepth& compare) {
    return network->ImageGradient(image, [&](const Buffer<float>& inv_depth) { return compare({inv_depth, {}}); });
  };
}

PseudoDepth StereoPseudoDepth(std::vector<LoadedView> views, std::vector<DepthMap> maps) {
  const auto own = std::make_shared<const OwnWarper>(std::move(views), std::move(maps));
  return [own](const Camera& camera, const Buffer<float>&, const CompareDepth& compare) {
    const WarpDepth seen = own->warper.Surfaces(camera);
    const Shape shape{camera.height, camera.width};
    DepthTarget target{Buffer<float>::From(shape, std::span<const float>(seen.inv_depth)), Buffer<float>::Zeros(shape)};
    for (int64_t i = 0; i < target.mask.count(); ++i) {
      const auto pixel = static_cast<size_t>(i);
      if (seen.inv_depth[pixel] > 0 || seen.beside[pixel] != 0) target.mask[i] = 1;
    }
    compare(target);
    return Buffer<float>();
  };
}

}  // namespace oraclegs
