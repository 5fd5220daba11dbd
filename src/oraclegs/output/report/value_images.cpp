#include "oraclegs/output/report/value_images.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "oraclegs/evaluate/pixel_errors.h"
#include "oraclegs/evaluate/uncertainty.h"
#include "oraclegs/image/colormap.h"
#include "oraclegs/render/recolor.h"
#include "oraclegs/render/render.h"
#include "oraclegs/render/surface.h"

namespace oraclegs {
namespace {

constexpr size_t kCamerasForSpan = 8;  // number of renders that decide the range of depth
constexpr int kNormalReachShare =
    240;  // the longer side over the reach in pixels; smooths the outlines of Gaussians in depth

/// Range of inverse depth that some of the cameras see, without the outermost percent.
std::pair<float, float> InverseDepthSpan(const Model& model, const std::vector<Camera>& cameras,
                                         Rasterizer* rasterizer) {
  std::vector<float> values;
  const size_t step = std::max<size_t>(1, (cameras.size() + kCamerasForSpan - 1) / kCamerasForSpan);
  for (size_t i = 0; i < cameras.size(); i += step) {
    const auto render = rasterizer->Forward(model.gaussians, cameras[i], model.render, RenderPass::kInference);
    for (const float value : SurfaceOf(render, cameras[i]).inv_depth) {
      if (value > 0) values.push_back(value);
    }
  }
  if (values.empty()) return {0.f, 1.f};
  std::sort(values.begin(), values.end());
  const size_t cut = values.size() / 100;
  return {values[cut], std::max(values[values.size() - 1 - cut], values[cut] * 1.001f)};
}

Image8 BlankRgb(const Camera& camera) {
  const auto bytes = 3 * static_cast<size_t>(camera.width) * static_cast<size_t>(camera.height);
  return {camera.width, camera.height, 3, std::vector<uint8_t>(bytes)};
}

Image8 DepthInColors(const RenderedSurface& surface, std::pair<float, float> span) {
  Image8 image = BlankRgb(surface.camera);
  for (size_t i = 0; i < surface.inv_depth.size(); ++i) {
    if (!(surface.inv_depth[i] > 0)) continue;
    const auto rgb = MapColor(ColorMap::kViridis, (surface.inv_depth[i] - span.first) / (span.second - span.first));
    std::copy(rgb.begin(), rgb.end(), image.data.begin() + static_cast<std::ptrdiff_t>(3 * i));
  }
  return image;
}

Image8 NormalsInColors(const RenderedSurface& surface) {
  Image8 image = BlankRgb(surface.camera);
  for (size_t i = 0; i < surface.normals.size(); ++i) {
    if (surface.normals[i].isZero()) continue;
    for (int c = 0; c < 3; ++c) {
      image.data[3 * i + static_cast<size_t>(c)] =
          static_cast<uint8_t>(std::lround(255 * (surface.normals[i][c] + 1) / 2));
    }
  }
  return image;
}

/// Throws InputError when the model lacks the marks that an image is made of.
void RequireMarks(const std::vector<float>& marks, const char* what) {
  if (!marks.empty()) return;
  throw InputError(
      "the point cloud has no property '{0}' of its Gaussians; train again with this version of oraclegs "
      "(--overwrite), or leave {0} out of --what",
      what);
}

/// [N,3]: each number in three channels.
Buffer<float> Gray(const std::vector<float>& values) {
  Buffer<float> colors = Buffer<float>::Empty({static_cast<int64_t>(values.size()), 3});
  for (size_t i = 0; i < values.size(); ++i) std::fill_n(colors.data() + 3 * i, 3, values[i]);
  return colors;
}

/// Expected errors in the colors of errors.
Image8 ErrorColors(const std::vector<float>& errors, const Camera& camera) {
  Image8 image = BlankRgb(camera);
  for (size_t p = 0; p < errors.size(); ++p) {
    const auto rgb = MapColor(ColorMap::kPlasma, errors[p] / kLargestShownError);
    std::copy(rgb.begin(), rgb.end(), image.data.begin() + static_cast<std::ptrdiff_t>(3 * p));
  }
  return image;
}

/// The mean of what each pixel blends, 0 where nothing is drawn; `render` is of Gaussians in gray, on black.
std::vector<float> BlendedMeans(const RenderOutput& render) {
  const Buffer<float> blended = render.image.To(kCpu), alpha = render.alpha.To(kCpu);
  std::vector<float> means(static_cast<size_t>(alpha.count()));
  for (int64_t p = 0; p < alpha.count(); ++p) {
    if (alpha[p] >= kDrawnAlpha) means[static_cast<size_t>(p)] = blended[3 * p] / alpha[p];
  }
  return means;
}

}  // namespace

std::vector<RenderValue> ParseRenderValues(const std::string& text) {
  std::vector<RenderValue> values;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find(',', begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    const auto value = FromWord<RenderValue>(word);
    if (!value) {
      throw UsageError("--what is '{}', must be one or more of: {} (separated by commas)", text,
                       AllWords<RenderValue>(", "));
    }
    if (std::find(values.begin(), values.end(), *value) == values.end()) values.push_back(*value);
    begin = end + 1;
  }
  return values;
}

struct ValueRenderer::Impl {
  bool Wants(RenderValue value) const { return std::find(values.begin(), values.end(), value) != values.end(); }

  const Model& model;
  std::vector<RenderValue> values;
  std::unique_ptr<Rasterizer> rasterizer;
  std::pair<float, float> span = {};  // range of inverse depth, for its colors
  Gaussians in_support_colors = {}, in_uncertainty = {};
  std::optional<Uncertainty> uncertainty = {};  // of the model among others
};

ValueRenderer::ValueRenderer(const Model& model, std::vector<RenderValue> values, const std::vector<Camera>& cameras)
    : impl_(new Impl{model, std::move(values), MakeRasterizer(model.gaussians.device())}) {
  if (impl_->Wants(RenderValue::kDepth)) impl_->span = InverseDepthSpan(model, cameras, impl_->rasterizer.get());
  if (impl_->Wants(RenderValue::kSupport)) {
    RequireMarks(model.marks.support, "support");
    impl_->in_support_colors = Recolored(model.gaussians, SupportColors(model.marks.support));
  }
  if (impl_->Wants(RenderValue::kUncertainty) && model.others) {
    impl_->uncertainty.emplace(model.gaussians, *model.others, model.render);
  } else if (impl_->Wants(RenderValue::kUncertainty)) {
    RequireMarks(model.marks.uncertainty, "uncertainty");
    impl_->in_uncertainty = Recolored(model.gaussians, Gray(model.marks.uncertainty));
  }
}

ValueRenderer::~ValueRenderer() = default;

std::vector<Image8> ValueRenderer::Render(const Camera& camera) {
  std::vector<Image8> images(impl_->values.size());
  const auto put = [&](RenderValue value, const auto& image) {
    const auto at = std::find(impl_->values.begin(), impl_->values.end(), value);
    if (at != impl_->values.end()) images[static_cast<size_t>(at - impl_->values.begin())] = image();
  };
  const auto is_mark = [](RenderValue value) {
    return value == RenderValue::kSupport || value == RenderValue::kUncertainty;
  };
  if (!std::all_of(impl_->values.begin(), impl_->values.end(), is_mark)) {
    const auto render =
        impl_->rasterizer->Forward(impl_->model.gaussians, camera, impl_->model.render, RenderPass::kInference);
    put(RenderValue::kColor, [&] { return ToImage8(render.image); });
    if (impl_->Wants(RenderValue::kDepth) || impl_->Wants(RenderValue::kNormals)) {
      const int reach = std::max(1, std::max(camera.width, camera.height) / kNormalReachShare);
      const RenderedSurface surface = SurfaceOf(render, camera, reach);
      put(RenderValue::kDepth, [&] { return DepthInColors(surface, impl_->span); });
      put(RenderValue::kNormals, [&] { return NormalsInColors(surface); });
    }
  }
  RenderOptions options = impl_->model.render;
  options.sh_degree = 0;
  put(RenderValue::kSupport, [&] {
    return ToImage8(
        impl_->rasterizer->Forward(impl_->in_support_colors, camera, options, RenderPass::kInference).image);
  });
  options.background = {0, 0, 0};
  put(RenderValue::kUncertainty, [&] {
    if (impl_->uncertainty) return ErrorColors(impl_->uncertainty->At(camera), camera);
    return ErrorColors(
        BlendedMeans(impl_->rasterizer->Forward(impl_->in_uncertainty, camera, options, RenderPass::kInference)),
        camera);
  });
  return images;
}

}  // namespace oraclegs
