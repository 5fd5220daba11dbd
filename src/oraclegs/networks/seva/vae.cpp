#include "oraclegs/networks/seva/vae.h"

namespace oraclegs::seva {
namespace {

constexpr int64_t kRgb = 3;

VaeEncoder LoadEncoder(const ParameterScope& at, const ParameterScope& root, const VaeConfig& config) {
  VaeEncoder encoder;
  const size_t levels = config.channels.size();
  const int64_t last = config.channels.back(), moments = 2 * config.latent_channels;
  encoder.conv_in = LoadConv(at / "conv_in", {kRgb, config.channels.front()});
  int64_t in = config.channels.front();
  for (size_t i = 0; i < levels; ++i) {
    const VaeResample resample = i + 1 < levels ? VaeResample::kHalve : VaeResample::kKeep;
    encoder.levels.push_back(LoadVaeLevel(at / "down_blocks" / static_cast<int64_t>(i),
                                          {in, config.channels[i], config.resnets, resample}, config.norm));
    in = config.channels[i];
  }
  encoder.middle = LoadVaeMiddle(at / "mid_block", last, config.norm);
  encoder.norm_out = LoadGroupNorm(at / "conv_norm_out", last, config.norm.groups, config.norm.eps);
  encoder.conv_out = LoadConv(at / "conv_out", {last, moments});
  encoder.quant = LoadConv(root / "quant_conv", {moments, moments, 1, 1, 0});
  return encoder;
}

VaeDecoder LoadDecoder(const ParameterScope& at, const ParameterScope& root, const VaeConfig& config) {
  VaeDecoder decoder;
  const size_t levels = config.channels.size();
  const int64_t first = config.channels.front(), latent = config.latent_channels;
  decoder.post_quant = LoadConv(root / "post_quant_conv", {latent, latent, 1, 1, 0});
  int64_t in = config.channels.back();
  decoder.conv_in = LoadConv(at / "conv_in", {latent, in});
  decoder.middle = LoadVaeMiddle(at / "mid_block", in, config.norm);
  for (size_t i = 0; i < levels; ++i) {
    const int64_t out = config.channels[levels - 1 - i];
    const VaeResample resample = i + 1 < levels ? VaeResample::kDouble : VaeResample::kKeep;
    decoder.levels.push_back(
        LoadVaeLevel(at / "up_blocks" / static_cast<int64_t>(i), {in, out, config.resnets + 1, resample}, config.norm));
    in = out;
  }
  decoder.norm_out = LoadGroupNorm(at / "conv_norm_out", first, config.norm.groups, config.norm.eps);
  decoder.conv_out = LoadConv(at / "conv_out", {first, kRgb});
  return decoder;
}

/// image [1, 3, H, W]: moments of its latents.
Tensor Moments(const VaeEncoder& encoder, const Tensor& image) {
  Tensor x = Forward(encoder.conv_in, image.to(encoder.conv_in.weight.options()));
  for (const VaeLevel& level : encoder.levels) x = Forward(level, std::move(x));
  x = NormThenSilu(encoder.norm_out, Forward(encoder.middle, x));
  return Forward(encoder.quant, Forward(encoder.conv_out, x)).to(torch::kFloat);
}

}  // namespace

Vae LoadVae(ParameterSource& source, const VaeConfig& config) {
  if (config.channels.empty()) throw ShapeError("LoadVae: the autoencoder has no levels");
  const ParameterScope root(source);
  return {config, LoadEncoder(root / "encoder", root, config), LoadDecoder(root / "decoder", root, config)};
}

Vae LoadVae(const std::filesystem::path& path, const VaeConfig& config, torch::Device device, torch::ScalarType type) {
  CheckpointOptions options;
  options.model = "the Stable Diffusion 2.1 autoencoder";
  options.older_names = {{".attentions.0.query.", ".attentions.0.to_q."},
                         {".attentions.0.key.", ".attentions.0.to_k."},
                         {".attentions.0.value.", ".attentions.0.to_v."},
                         {".attentions.0.proj_attn.", ".attentions.0.to_out.0."}};
  options.device = device;
  options.cast_type = type;
  FileParameters source({path}, options);
  Vae vae = LoadVae(source, config);
  source.Finish();
  return vae;
}

Tensor LatentMoments(const Vae& vae, const Tensor& images) {
  RequireImages("LatentMoments", images, vae.config.downscale());
  std::vector<Tensor> moments;
  for (int64_t i = 0; i < images.size(0); ++i) moments.push_back(Moments(vae.encoder, images.slice(0, i, i + 1)));
  return at::cat(moments);
}

Tensor EncodeImages(const Vae& vae, const Tensor& images) {
  return LatentMoments(vae, images).slice(1, 0, vae.config.latent_channels) * vae.config.latent_scale;
}

Tensor DecodeMiddle(const VaeDecoder& decoder, const Tensor& z) {
  const Tensor unquantized = Forward(decoder.post_quant, z.to(decoder.post_quant.weight.options()));
  return Forward(decoder.middle, Forward(decoder.conv_in, unquantized));
}

Tensor DecodeLevels(const VaeDecoder& decoder, const Tensor& middle) {
  Tensor x = middle;
  for (const VaeLevel& level : decoder.levels) x = Forward(level, std::move(x));
  return Forward(decoder.conv_out, NormThenSilu(decoder.norm_out, x));
}

Tensor DecodeLatents(const Vae& vae, const Tensor& latents) {
  RequireLatents("DecodeLatents", latents, vae.config);
  std::vector<Tensor> images;
  for (int64_t i = 0; i < latents.size(0); ++i) {
    const Tensor z = latents.slice(0, i, i + 1) / vae.config.latent_scale;
    images.push_back(DecodeLevels(vae.decoder, DecodeMiddle(vae.decoder, z)).to(torch::kFloat));
  }
  return at::cat(images);
}

void RequireLatents(const char* who, const Tensor& latents, const VaeConfig& config) {
  const bool ok = latents.defined() && latents.dim() == 4 && latents.scalar_type() == torch::kFloat &&
                  latents.numel() > 0 && latents.size(1) == config.latent_channels;
  if (ok) return;
  if (!latents.defined()) throw ShapeError("{}: the latents are undefined", who);
  throw ShapeError("{}: the latents are [{}] {}, expected float32 [any, {}, h, w]", who,
                   fmt::join(latents.sizes(), ", "), c10::toString(latents.scalar_type()), config.latent_channels);
}

}  // namespace oraclegs::seva
