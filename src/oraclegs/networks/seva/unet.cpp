#include "oraclegs/networks/seva/unet.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "oraclegs/networks/common/autocast.h"
#include "oraclegs/networks/seva/kernels.h"
#include "oraclegs/networks/seva/sums.h"

namespace oraclegs::seva {
namespace {

/// Adds layers to blocks and tracks channels and downscale.
class Builder {
 public:
  Builder(Unet* unet, const ParameterScope& root) : unet_(unet), config_(unet->config), root_(root) {}

  void Build() {
    const auto levels = static_cast<int64_t>(config_.channel_mult.size());
    AddInput(LoadConv(root_ / "input_blocks" / 0 / 0, {config_.in_channels, config_.channels}));
    channels_ = config_.channels;
    skips_.push_back(channels_);
    for (int64_t level = 0; level < levels; ++level) BuildDown(level, level + 1 == levels);
    const ParameterScope middle = root_ / "middle_block";
    unet_->middle.push_back(Res(middle / 0, channels_));
    unet_->middle.push_back(NextMultiView(middle / 1, "middle", levels - 1));
    unet_->middle.push_back(Res(middle / 2, channels_));
    for (int64_t level = levels - 1; level >= 0; --level) BuildUp(level);
    unet_->norm_out = LoadGroupNorm(root_ / "out" / 0, channels_, config_.groups, 1e-5);
    unet_->conv_out = LoadConv(root_ / "out" / 2, {channels_, config_.out_channels});
  }

 private:
  ParameterScope NextInput() const { return root_ / "input_blocks" / static_cast<int64_t>(unet_->input_blocks.size()); }
  void AddInput(UnetLayer layer) { unet_->input_blocks.push_back({std::move(layer)}); }
  bool HasMultiView() const {
    const auto& all = config_.attention_downscales;
    return std::find(all.begin(), all.end(), downscale_) != all.end();
  }

  ResBlock Res(const ParameterScope& at, int64_t out) {
    ResBlock block =
        LoadResBlock(at, {channels_, out, config_.embedding_width(), config_.dense_channels, config_.groups});
    channels_ = out;
    return block;
  }

  MultiView NextMultiView(const ParameterScope& at, const char* side, int64_t level) {
    const std::string name = fmt::format("{}_ds{}", side, downscale_);
    const auto& joint = config_.joint;
    const bool sequence = std::find(joint.begin(), joint.end(), name) != joint.end();
    MultiView block =
        LoadMultiView(at, {channels_, config_.head_width, config_.transformer_depth.at(static_cast<size_t>(level)),
                           config_.context_width, config_.groups, sequence ? Reach::kSequence : Reach::kFrame});
    block.index = multi_views_++;
    return block;
  }

  void BuildDown(int64_t level, bool last) {
    const int64_t out = config_.channels * config_.channel_mult[static_cast<size_t>(level)];
    for (int64_t i = 0; i < config_.res_blocks; ++i) {
      const ParameterScope at = NextInput();
      AddInput(Res(at / 0, out));
      if (HasMultiView()) unet_->input_blocks.back().push_back(NextMultiView(at / 1, "input", level));
      skips_.push_back(channels_);
    }
    if (last) return;
    AddInput(LoadConv(NextInput() / 0 / "op", {channels_, channels_, 3, 2, 1}));
    skips_.push_back(channels_);
    downscale_ *= 2;
  }

  void BuildUp(int64_t level) {
    const int64_t out = config_.channels * config_.channel_mult[static_cast<size_t>(level)];
    for (int64_t i = 0; i <= config_.res_blocks; ++i) {
      const ParameterScope at = root_ / "output_blocks" / static_cast<int64_t>(unet_->output_blocks.size());
      channels_ += skips_.back();
      skips_.pop_back();
      UnetBlock block;
      block.push_back(Res(at / 0, out));
      if (HasMultiView()) block.push_back(NextMultiView(at / 1, "output", level));
      if (i == config_.res_blocks && level > 0) {
        const auto place = static_cast<int64_t>(block.size());
        block.push_back(Up{LoadConv(at / place / "conv", {channels_, channels_})});
        downscale_ /= 2;
      }
      unet_->output_blocks.push_back(std::move(block));
    }
  }

  Unet* unet_;
  const UnetConfig& config_;
  ParameterScope root_;
  std::vector<int64_t> skips_;
  int64_t channels_ = 0, downscale_ = 1;
  size_t multi_views_ = 0;
};

/// Calls f(transformer) for each multi-view transformer of a network, in the order of their indices.
template <class F>
void ForEachMultiView(const Unet& unet, F&& f) {
  const auto visit = [&](const UnetBlock& block) {
    for (const UnetLayer& layer : block) {
      if (const auto* multi_view = std::get_if<MultiView>(&layer)) f(*multi_view);
    }
  };
  for (const UnetBlock& block : unet.input_blocks) visit(block);
  visit(unet.middle);
  for (const UnetBlock& block : unet.output_blocks) visit(block);
}

/// Calls f(&layer) for each convolution and group norm.
template <class F>
void ForEachMapLayer(Unet* unet, F&& f) {
  const auto visit = [&](UnetBlock* block) {
    for (UnetLayer& layer : *block) {
      if (auto* conv = std::get_if<Conv>(&layer)) f(conv);
      if (auto* up = std::get_if<Up>(&layer)) f(&up->conv);
      if (auto* res = std::get_if<ResBlock>(&layer)) {
        f(&res->norm_in), f(&res->conv_in), f(&res->dense), f(&res->norm_out), f(&res->conv_out);
        if (res->skip) f(&*res->skip);
      }
      if (auto* multi_view = std::get_if<MultiView>(&layer)) f(&multi_view->norm);
    }
  };
  for (UnetBlock& block : unet->input_blocks) visit(&block);
  visit(&unet->middle);
  for (UnetBlock& block : unet->output_blocks) visit(&block);
  f(&unet->norm_out), f(&unet->conv_out);
}

at::MemoryFormat FormatOf(const Unet& unet) {
  return unet.channels_last ? at::MemoryFormat::ChannelsLast : at::MemoryFormat::Contiguous;
}

/// Halves the batch: cuDNN 9 takes a kernel half as fast for all maps of the largest size than for half of them (H200,
/// 42 of 640 x 72 x 72).
Tensor ConvolveUpsampled(const Conv& layer, const Tensor& x) {
  const int64_t half = x.size(0) / 2;
  if (half == 0 || !kernels::CanTake(x)) return ConvolveMap(layer, x);
  return at::cat({ConvolveMap(layer, x.slice(0, 0, half)), ConvolveMap(layer, x.slice(0, half, x.size(0)))});
}

const Tensor& DenseOf(const Conditioning& conditioning, const Tensor& x) {
  for (const Tensor& dense : conditioning.dense) {
    if (dense.size(2) == x.size(2) && dense.size(3) == x.size(3)) return dense;
  }
  throw ShapeError("Unet: no rays were prepared for maps of {} x {}", x.size(2), x.size(3));
}

std::string PrefixOf(const std::filesystem::path& path) {
  const SafetensorsFile file = SafetensorsFile::Open(path);
  const auto& tensors = file.tensors();
  return !tensors.empty() && tensors.begin()->first.starts_with("module.") ? "module." : "";
}

}  // namespace

void KeepChannelsLast(Unet* unet) {
  unet->channels_last = true;
  ForEachMapLayer(unet, [](auto* layer) {
    layer->channels_last = true;
    if constexpr (std::is_same_v<decltype(layer), Conv*>) {
      layer->weight = layer->weight.contiguous(at::MemoryFormat::ChannelsLast);
    }
  });
}

Unet LoadUnet(ParameterSource& source, const UnetConfig& config) {
  const size_t levels = config.channel_mult.size();
  if (levels == 0 || config.transformer_depth.size() != levels) {
    throw ShapeError("LoadUnet: {} levels with {} depths of transformers", levels, config.transformer_depth.size());
  }
  Unet unet;
  unet.config = config;
  const ParameterScope root(source);
  const int64_t width = config.embedding_width();
  unet.time1 = LoadLinear(root / "time_embed" / 0, config.channels, width);
  unet.time2 = LoadLinear(root / "time_embed" / 2, width, width);
  Builder(&unet, root).Build();
  const Tensor& weight = unet.any_weight();
  if (kernels::CanTake(weight)) KeepChannelsLast(&unet);
  return unet;
}

Unet LoadUnet(const std::vector<std::filesystem::path>& paths, const UnetConfig& config, const Placement& placement) {
  CheckpointOptions options;
  options.model = "the UNet of Stable Virtual Camera";
  options.prefix = paths.empty() ? "" : PrefixOf(paths.front());
  options.device = placement.device;
  options.cast_type = placement.type;
  FileParameters source(paths, options);
  Unet unet = LoadUnet(source, config);
  unet.products = placement.products;
  source.Finish();
  return unet;
}

Conditioning Prepare(const Unet& unet, const Conditions& in) {
  const int64_t downscale = unet.config.downscale();
  const bool fits = in.context.defined() && in.dense.defined() && in.context.dim() == 3 && in.dense.dim() == 4 &&
                    in.frames > 0 && in.context.size(0) == in.dense.size(0) && in.context.size(0) % in.frames == 0 &&
                    in.height > 0 && in.width > 0 && in.height % downscale == 0 && in.width % downscale == 0;
  if (!fits) {
    throw ShapeError(
        "Prepare: contexts and rays of {} and {} rows must be whole sequences of {} frames, and latents of {} x {} "
        "multiples of {}",
        in.context.defined() ? in.context.size(0) : 0, in.dense.defined() ? in.dense.size(0) : 0, in.frames, in.width,
        in.height, downscale);
  }
  const at::TensorOptions options = unet.any_weight().options();
  const Autocast scope(unet.any_weight().device(), unet.products);
  Conditioning out;
  out.frames = in.frames;
  const Tensor dense = in.dense.to(options.dtype(torch::kFloat));
  for (int64_t scale = 1; scale <= downscale; scale *= 2) {
    const int64_t height = in.height / scale, width = in.width / scale;
    const bool same = dense.size(2) == height && dense.size(3) == width;
    out.dense.push_back((same ? dense : ResizeBilinear(dense, height, width, Corners::kAligned))
                            .to(options)
                            .contiguous(FormatOf(unet)));
  }
  const Tensor context = in.context.to(options);
  ForEachMultiView(unet,
                   [&](const MultiView& block) { out.contexts.push_back(PrepareContext(block, context, in.frames)); });
  return out;
}

Tensor TimeEmbedding(const Unet& unet, const Tensor& steps) {
  const int64_t half = unet.config.channels / 2;
  const auto options = unet.any_weight().options().dtype(torch::kFloat);
  const Tensor frequencies =
      at::exp(at::arange(half, options).mul_(-std::log(10000.0)).div_(static_cast<double>(half)));
  const Tensor angles = steps.to(options).unsqueeze(1) * frequencies.unsqueeze(0);
  Tensor waves = at::cat({at::cos(angles), at::sin(angles)}, 1);
  if (unet.config.channels % 2 != 0) waves = at::cat({waves, at::zeros({waves.size(0), 1}, options)}, 1);
  return Forward(unet.time2, at::silu(Forward(unet.time1, waves.to(unet.any_weight().scalar_type()))));
}

Tensor Forward(const UnetBlock& block, const Tensor& x, const Tensor& embedding, const Conditioning& conditioning) {
  Tensor y = x;
  for (const UnetLayer& layer : block) {
    if (const auto* res = std::get_if<ResBlock>(&layer)) {
      y = Forward(*res, y, embedding, DenseOf(conditioning, y));
    } else if (const auto* multi_view = std::get_if<MultiView>(&layer)) {
      y = Forward(*multi_view, y, conditioning.contexts.at(multi_view->index), conditioning.frames);
    } else if (const auto* up = std::get_if<Up>(&layer)) {
      y = ConvolveUpsampled(up->conv, at::upsample_nearest2d(y, {2 * y.size(2), 2 * y.size(3)}));
    } else {
      y = ConvolveMap(std::get<Conv>(layer), y);
    }
  }
  return y;
}

Tensor Forward(const Unet& unet, const Tensor& x, const Tensor& steps, const Conditioning& conditioning) {
  const bool fits = x.dim() == 4 && x.size(1) == unet.config.in_channels && steps.dim() == 1 &&
                    steps.size(0) == x.size(0) && !conditioning.dense.empty() &&
                    conditioning.dense.front().size(0) == x.size(0);
  if (!fits) {
    throw ShapeError("Unet: x is [{}] and steps [{}], expected [N, {}, h, w] and [N] as they were prepared",
                     fmt::join(x.sizes(), ", "), fmt::join(steps.sizes(), ", "), unet.config.in_channels);
  }
  const Autocast scope(unet.any_weight().device(), unet.products);
  const Tensor embedding = at::silu(TimeEmbedding(unet, steps));
  Tensor y = x.to(unet.any_weight().options()).contiguous(FormatOf(unet));
  std::vector<Tensor> skips;
  for (const UnetBlock& block : unet.input_blocks) {
    y = Forward(block, y, embedding, conditioning);
    skips.push_back(y);
  }
  y = Forward(unet.middle, y, embedding, conditioning);
  for (const UnetBlock& block : unet.output_blocks) {
    y = at::cat({y, skips.back()}, 1);
    skips.pop_back();
    y = Forward(block, y, embedding, conditioning);
  }
  return ConvolveMap(unet.conv_out, NormThenSilu(unet.norm_out, y)).to(torch::kFloat).contiguous();
}

}  // namespace oraclegs::seva
