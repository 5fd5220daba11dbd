#pragma once
// Weight files of a SEVA of a few thousand numbers, as Model reads them.

#include "networks/network_files.h"
#include "networks/seva/tiny_seva.h"
#include "oraclegs/networks/seva/model.h"
#include "oraclegs/networks/seva/openclip.h"
#include "oraclegs/networks/seva/vae.h"

namespace oraclegs::seva {

/// Writes dir/seva, dir/sd21-vae and dir/openclip-vith14, each with model.safetensors.
inline SevaFiles MakeTinySeva(const std::filesystem::path& dir) {
  SevaFiles files{{dir / "seva" / "model.safetensors"},
                  dir / "sd21-vae" / "model.safetensors",
                  dir / "openclip-vith14" / "model.safetensors"};
  const UnetConfig unet = TinyUnetConfig();
  KeptParameters unet_source(1), vae_source(2), clip_source(3);
  LoadUnet(unet_source, unet);
  unet_source.Write(files.unet.front(), {{"model_channels", unet.channels},
                                         {"channel_mult", unet.channel_mult},
                                         {"num_res_blocks", unet.res_blocks},
                                         {"attention_resolutions", unet.attention_downscales},
                                         {"num_head_channels", unet.head_width},
                                         {"transformer_depth", unet.transformer_depth},
                                         {"context_dim", unet.context_width},
                                         {"norm_num_groups", unet.groups},
                                         {"unflatten_names", unet.joint}});
  VaeConfig vae;
  vae.channels = {4, 4, 8, 8};
  vae.resnets = 1;
  vae.norm.groups = 4;
  LoadVae(vae_source, vae);
  vae_source.Write(files.vae, {{"block_out_channels", vae.channels}, {"layers_per_block", 1}, {"norm_num_groups", 4}});
  OpenClipConfig clip;
  clip.width = 8;
  clip.depth = 1;
  clip.heads = 2;
  clip.hidden = 32;
  clip.patch = 112;
  clip.output = kTinyContext;
  LoadOpenClip(ParameterScope(clip_source) / "visual", clip);
  clip_source.Write(files.clip,
                    {{"patch_size", 112}, {"width", 8}, {"layers", 1}, {"heads", 2}, {"output_dim", kTinyContext}});
  return files;
}

}  // namespace oraclegs::seva
