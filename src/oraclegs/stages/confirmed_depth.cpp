#include "oraclegs/stages/confirmed_depth.h"

#include "oraclegs/depth/plane_search.h"
#include "oraclegs/depth/stereo.h"
#include "oraclegs/scene/frame.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {
namespace {

constexpr int kSide = 250;  // pixels

}  // namespace

std::vector<double> ConfirmedDepth(Scene model, Device device) {
  const std::vector<int> all = AllViews(model);
  ApplyFrame(NormalFrame(model, all), &model);
  ImageOptions small;
  small.max_size = kSide;
  const std::vector<LoadedView> views = LoadViews(model, all, small, Silent());
  std::vector<double> shares;
  for (const DepthMap& map :
       EstimateDepth(views, model.points, StereoOptions(), MakePlaneSearch(device).get(), Silent())) {
    shares.push_back(ConfidentShare(map));
  }
  return shares;
}

}  // namespace oraclegs
