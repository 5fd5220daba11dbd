#include "oraclegs/networks/seva/model.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "oraclegs/networks/seva/openclip.h"
#include "oraclegs/networks/seva/vae_tiles.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

/// What a file says of its network; values are JSON.
class Sizes {
 public:
  explicit Sizes(const fs::path& path) : path_(path), metadata_(SafetensorsFile::Open(path).metadata()) {}

  /// Leaves `value` as it is where the file says nothing.
  template <class T>
  void Read(const char* name, T* value) const {
    const auto text = metadata_.find(name);
    if (text == metadata_.end()) return;
    try {
      *value = nlohmann::json::parse(text->second).get<T>();
    } catch (const nlohmann::json::exception&) {
      throw InputError("{}: says that {} is '{}', which it cannot be; get the weights again", path_.string(), name,
                       text->second);
    }
  }

 private:
  fs::path path_;
  std::map<std::string, std::string> metadata_;
};

SevaUnetConfig UnetConfigOf(const fs::path& path) {
  SevaUnetConfig config;
  const Sizes sizes(path);
  sizes.Read("model_channels", &config.channels);
  sizes.Read("num_res_blocks", &config.res_blocks);
  sizes.Read("attention_resolutions", &config.attention_downscales);
  sizes.Read("channel_mult", &config.channel_mult);
  sizes.Read("num_head_channels", &config.head_width);
  sizes.Read("transformer_depth", &config.transformer_depth);
  sizes.Read("context_dim", &config.context_width);
  sizes.Read("norm_num_groups", &config.groups);
  sizes.Read("unflatten_names", &config.joint);
  return config;
}

VaeConfig VaeConfigOf(const fs::path& path) {
  VaeConfig config;
  const Sizes sizes(path);
  sizes.Read("block_out_channels", &config.channels);
  sizes.Read("layers_per_block", &config.resnets);
  sizes.Read("latent_channels", &config.latent_channels);
  sizes.Read("norm_num_groups", &config.norm.groups);
  return config;
}

OpenClipConfig ClipConfigOf(const fs::path& path) {
  OpenClipConfig config;
  const Sizes sizes(path);
  sizes.Read("image_size", &config.image_side);
  sizes.Read("patch_size", &config.patch);
  sizes.Read("width", &config.width);
  sizes.Read("layers", &config.depth);
  sizes.Read("heads", &config.heads);
  sizes.Read("output_dim", &config.output);
  double ratio = 4;
  sizes.Read("mlp_ratio", &ratio);
  config.hidden = static_cast<int64_t>(ratio * static_cast<double>(config.width));
  return config;
}

}  // namespace

struct SevaModel::State {
  SevaFiles files;
  SevaPlacement placement;
  VaeConfig vae_config;
  OpenClipConfig clip_config;
  SevaUnet unet;
  std::optional<Vae> vae;
  std::optional<OpenClip> clip;

  /// Mapped files cost nothing to keep; elsewhere only what works next is there.
  void Place(SevaPart part) {
    const bool stays = placement.device.is_cpu();
    if (part == SevaPart::kUnet && !stays) vae.reset();
    if (part != SevaPart::kEncoder && !stays) clip.reset();
    if (part != SevaPart::kUnet && !vae) vae = LoadVae(files.vae, vae_config, placement.device, placement.type);
    if (part == SevaPart::kEncoder && !clip) {
      clip = LoadOpenClip(files.clip, clip_config, placement.device, placement.type);
    }
  }
};

torch::ScalarType SevaPrecision(const std::string& word) {
  if (word == "float32") return torch::kFloat;
  if (word == "bfloat16") return torch::kBFloat16;
  if (word == "float16") return torch::kHalf;
  throw UsageError("'{}' is no number type of seva; float32, bfloat16 or float16", word);
}

SevaModel::SevaModel(const SevaFiles& files, const SevaPlacement& placement) : state_(std::make_unique<State>()) {
  if (files.unet.empty()) throw ShapeError("SevaModel: there is no file of the UNet");
  state_->files = files;
  state_->placement = placement;
  state_->vae_config = VaeConfigOf(files.vae);
  state_->clip_config = ClipConfigOf(files.clip);
  state_->unet = LoadSevaUnet(files.unet, UnetConfigOf(files.unet.front()), placement);
  state_->Place(SevaPart::kEncoder);  // what is wrong with the files is told now
  state_->Place(SevaPart::kUnet);
  const int64_t wanted = state_->unet.config.context_width, given = state_->clip_config.output;
  if (wanted != given) {
    throw InputError("{}: gives embeddings of {} numbers and {} takes {}; get the weights again", files.clip.string(),
                     given, files.unet.front().string(), wanted);
  }
}

SevaModel::~SevaModel() = default;

SevaNetworks SevaModel::networks() const {
  State* state = state_.get();
  SevaNetworks networks;
  networks.unet = &state->unet;
  networks.place = [state](SevaPart part) { state->Place(part); };
  networks.encode = [state](const Tensor& picture) { return EncodeImages(*state->vae, picture); };
  networks.decode = [state](const Tensor& latent, int64_t side) {
    return DecodeTiled(*state->vae, latent, {side, std::max<int64_t>(1, side / 3)});
  };
  networks.embed = [state](const Tensor& picture) { return ImageEmbeddings(*state->clip, picture); };
  networks.pictures = EstimatePictures(state->vae_config, state->placement.type);
  const auto bytes = [](const fs::path& file) { return static_cast<int64_t>(fs::file_size(file)); };
  if (state->placement.device.is_cpu()) {
    networks.other_weights = bytes(state->files.vae) + bytes(state->files.clip);
  } else {
    networks.pictures.weights = bytes(state->files.vae) + bytes(state->files.clip);
  }
  return networks;
}

}  // namespace oraclegs
