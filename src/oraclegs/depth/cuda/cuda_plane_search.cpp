#include "oraclegs/depth/plane_search.h"

#include <algorithm>

#include "oraclegs/core/cuda/device_array.h"
#include "oraclegs/core/error.h"
#include "oraclegs/depth/cuda/half_sweep.h"

namespace oraclegs::cuda {
namespace {

/// Plane search on a GPU. Arrays hold all views in order; view v's pixels begin at first_[v].
class CudaPlaneSearch final : public PlaneSearch {
 public:
  explicit CudaPlaneSearch(int index) : index_(index) { UseDevice(index); }

  void BeginLevel(const StereoScene& scene, std::vector<PlaneMap> maps) override {
    UseDevice(index_);
    scene_ = &scene;
    CheckShapes(maps);
    const int64_t pixels = first_.back();
    words_.ReserveExactly(pixels * channels_);
    planes_.ReserveExactly(pixels);
    before_.ReserveExactly(pixels);
    costs_.ReserveExactly(pixels);
    for (size_t v = 0; v < maps.size(); ++v) {
      const GatherImage& image = scene.views[v].image;
      for (int c = 0; c < channels_; ++c) {
        Send(image.channels[static_cast<size_t>(c)], &words_, channels_ * first_[v] + c * Pixels(v));
      }
      Send(maps[v].planes, &planes_, first_[v]);
      Send(maps[v].costs, &costs_, first_[v]);
    }
    SendUsable();
    SendSilhouettes();
  }

  void BeginPass(const SearchPass& pass) override {
    UseDevice(index_);
    pass_ = pass;
    if (!pass.geometric || first_.back() == 0) return;
    Check(cudaMemcpyAsync(before_.data(), planes_.data(), static_cast<size_t>(first_.back()) * sizeof(Plane),
                          cudaMemcpyDeviceToDevice, kStream),
          "keeping stereo's planes");
  }

  void Improve(size_t view) override {
    UseDevice(index_);
    HalfSweep sweep = SweepOf(view);
    if (sweep.view.num_sources == 0) return;
    for (sweep.iteration = 0; sweep.iteration < pass_.iterations; ++sweep.iteration) {
      for (sweep.color = 0; sweep.color < 2; ++sweep.color) RunHalfSweep(sweep, kStream);
    }
    done_.Record(kStream);
    done_.Wait();  // so that progress is reported, and an interrupt obeyed, when the work is done
  }

  std::vector<PlaneMap> EndLevel() override {
    UseDevice(index_);
    std::vector<PlaneMap> maps;
    for (size_t v = 0; v < scene_->views.size(); ++v) {
      const Camera& camera = scene_->views[v].camera;
      const auto pixels = static_cast<size_t>(Pixels(v));
      PlaneMap map{camera.width, camera.height, std::vector<Plane>(pixels), std::vector<float>(pixels)};
      Fetch(planes_, first_[v], &map.planes);
      Fetch(costs_, first_[v], &map.costs);
      maps.push_back(std::move(map));
    }
    return maps;
  }

 private:
  int64_t Pixels(size_t view) const { return first_[view + 1] - first_[view]; }

  /// Sets first_ and channels_, and throws unless all arrays have the sizes that the kernels read.
  void CheckShapes(const std::vector<PlaneMap>& maps) {
    const std::vector<StereoView>& views = scene_->views;
    if (maps.size() != views.size()) throw ShapeError("stereo: {} maps of {} views", maps.size(), views.size());
    first_.assign(1, 0);
    channels_ = views.empty() ? 1 : static_cast<int>(views.front().image.channels.size());
    for (size_t v = 0; v < views.size(); ++v) {
      const Camera& camera = views[v].camera;
      const size_t pixels = static_cast<size_t>(camera.width) * static_cast<size_t>(camera.height);
      const std::vector<std::vector<uint32_t>>& channels = views[v].image.channels;
      const bool right =
          (channels_ == 1 || channels_ == kMaxChannels) && static_cast<int>(channels.size()) == channels_ &&
          std::all_of(channels.begin(), channels.end(), [&](const auto& words) { return words.size() == pixels; }) &&
          maps[v].planes.size() == pixels && maps[v].costs.size() == pixels &&
          (views[v].usable.empty() || views[v].usable.size() == pixels);
      if (!right) throw ShapeError("stereo: view {} is not {} x {} in all its parts", v, camera.width, camera.height);
      first_.push_back(first_.back() + static_cast<int64_t>(pixels));
    }
  }

  void SendUsable() {
    const auto has_mask = [](const StereoView& view) { return !view.usable.empty(); };
    if (std::none_of(scene_->views.begin(), scene_->views.end(), has_mask)) return;
    usable_.ReserveExactly(first_.back());
    for (size_t v = 0; v < scene_->views.size(); ++v) Send(scene_->views[v].usable, &usable_, first_[v]);
  }

  /// Sends, for each view, the list of the silhouettes of all others.
  void SendSilhouettes() {
    silhouettes_a_view_ = 0;
    if (scene_->silhouettes == nullptr || scene_->silhouettes->empty()) return;
    const size_t n = scene_->views.size();
    std::vector<int64_t> first(1, 0);
    for (size_t v = 0; v < n; ++v) {
      const SilhouetteMask mask = scene_->silhouettes->Mask(v);
      first.push_back(first.back() + static_cast<int64_t>(mask.width) * mask.height);
    }
    grown_.ReserveExactly(first.back());
    for (size_t v = 0; v < n; ++v) {
      const uint8_t* grown = scene_->silhouettes->Mask(v).grown;
      Check(cudaMemcpy(grown_.data() + first[v], grown, static_cast<size_t>(first[v + 1] - first[v]),
                       cudaMemcpyHostToDevice),
            kSilhouettes);
    }
    std::vector<SearchSilhouette> all;
    for (size_t view = 0; view < n; ++view) {
      std::vector<SearchSilhouette> others = SilhouettesFor(*scene_, view);
      for (size_t k = 0; k < others.size(); ++k) {
        others[k].mask.grown = grown_.data() + first[k < view ? k : k + 1];  // the view itself is left out
      }
      all.insert(all.end(), others.begin(), others.end());
    }
    silhouettes_a_view_ = static_cast<int>(n) - 1;
    silhouettes_.Upload(all.data(), static_cast<int64_t>(all.size()));
  }

  SweepImage ImageOf(size_t view) const {
    const Camera& camera = scene_->views[view].camera;
    return {words_.data() + channels_ * first_[view], camera.width, camera.height};
  }

  HalfSweep SweepOf(size_t view) {
    const StereoView& v = scene_->views[view];
    HalfSweep sweep{SearchOf(*scene_, view), ImageOf(view), {}, channels_, 0, 0};
    SearchView& search = sweep.view;
    search.pass = pass_.number;
    search.local = pass_.local;
    if (!v.usable.empty()) search.usable = usable_.data() + first_[view];
    search.planes = planes_.data() + first_[view];
    search.costs = costs_.data() + first_[view];
    for (int s = 0; s < search.num_sources; ++s) {
      const auto n = static_cast<size_t>(v.neighbors[static_cast<size_t>(s)]);
      sweep.sources[s] = ImageOf(n);
      if (pass_.geometric) search.sources[s].known.planes = before_.data() + first_[n];
    }
    search.num_silhouettes = silhouettes_a_view_;
    search.silhouettes = silhouettes_.data() + static_cast<int64_t>(view) * silhouettes_a_view_;
    return sweep;
  }

  template <class T>
  static void Send(const std::vector<T>& from, DeviceArray<T>* to, int64_t first) {
    if (from.empty()) return;
    Check(cudaMemcpy(to->data() + first, from.data(), from.size() * sizeof(T), cudaMemcpyHostToDevice),
          "sending stereo's images and planes");
  }
  template <class T>
  static void Fetch(const DeviceArray<T>& from, int64_t first, std::vector<T>* to) {
    if (to->empty()) return;
    Check(cudaMemcpy(to->data(), from.data() + first, to->size() * sizeof(T), cudaMemcpyDeviceToHost),
          "fetching stereo's planes");
  }

  static constexpr const char* kSilhouettes = "the silhouettes of the object, for stereo";

  int index_;
  const StereoScene* scene_ = nullptr;
  SearchPass pass_;
  std::vector<int64_t> first_{0};
  int channels_ = 1, silhouettes_a_view_ = 0;
  DeviceArray<uint32_t> words_{"the images, for stereo"};
  DeviceArray<uint8_t> usable_{"the images' masks, for stereo"};
  DeviceArray<Plane> planes_{"stereo's planes"}, before_{"stereo's planes of the pass before"};
  DeviceArray<float> costs_{"the costs of stereo's planes"};
  DeviceArray<uint8_t> grown_{kSilhouettes};
  DeviceArray<SearchSilhouette> silhouettes_{kSilhouettes};
  Event done_;
};

}  // namespace

std::unique_ptr<PlaneSearch> MakeCudaPlaneSearch(int index) { return std::make_unique<CudaPlaneSearch>(index); }

}  // namespace oraclegs::cuda
