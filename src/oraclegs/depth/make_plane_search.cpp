#include "oraclegs/depth/plane_search.h"

#include <utility>

#include "oraclegs/core/cuda_library.h"
#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

class CpuPlaneSearch final : public PlaneSearch {
 public:
  void BeginLevel(const StereoScene& scene, std::vector<PlaneMap> maps) override {
    scene_ = &scene;
    maps_ = std::move(maps);
  }

  void BeginPass(const SearchPass& pass) override {
    pass_ = pass;
    if (pass.geometric) before_ = maps_;
  }

  void Improve(size_t view) override {
    RunPass(*scene_, view, {pass_.iterations, pass_.number, pass_.geometric ? &before_ : nullptr, pass_.local},
            &maps_[view]);
  }

  std::vector<PlaneMap> EndLevel() override {
    before_.clear();
    return std::exchange(maps_, {});
  }

 private:
  const StereoScene* scene_ = nullptr;
  std::vector<PlaneMap> maps_, before_;
  SearchPass pass_;
};

}  // namespace

std::unique_ptr<PlaneSearch> MakePlaneSearch(Device device) {
  if (device.is_cpu()) return std::make_unique<CpuPlaneSearch>();
  return CudaFunction<decltype(cuda::MakeCudaPlaneSearch)>("MakeCudaPlaneSearch")(device.index);
}

}  // namespace oraclegs
