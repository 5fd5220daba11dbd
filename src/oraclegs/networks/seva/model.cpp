#include "oraclegs/networks/seva/model.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "oraclegs/networks/common/autocast.h"
#include "oraclegs/networks/common/tensor.h"
#include "oraclegs/networks/seva/openclip.h"
#include "oraclegs/networks/seva/vae_tiles.h"

namespace oraclegs::seva {
namespace {

namespace fs = std::filesystem;

/// Metadata of a file that give the sizes of its network; values are JSON.
class Sizes {
 public:
  explicit Sizes(const fs::path& path) : path_(path), metadata_(SafetensorsFile::Open(path).metadata()) {}

  /// Leaves `value` unchanged where the file has no such entry.
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

UnetConfig UnetConfigOf(const fs::path& path) {
  UnetConfig config;
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

int64_t EncoderBytes(const SevaFiles& files) {
  return static_cast<int64_t>(fs::file_size(files.vae) + fs::file_size(files.clip));
}

/// Bytes of the encoders that stay while the UNet works: on the CPU all of them, elsewhere none.
int64_t OtherWeightsOf(const SevaFiles& files, const Placement& placement) {
  return placement.device.is_cpu() ? EncoderBytes(files) : 0;
}

AutoencoderMemory MemoryOf(const SevaFiles& files, const VaeConfig& config, const Placement& placement) {
  AutoencoderMemory memory = EstimateAutoencoder(config, placement.type);
  if (!placement.device.is_cpu()) memory.weights = EncoderBytes(files);
  return memory;
}

class LoadedGenerator : public ViewGenerator {
 public:
  explicit LoadedGenerator(const ViewGeneratorRequest& request)
      : model_(request.files, PlaceOn(ToTorch(request.device), request.options.precision)),
        options_(request.options),
        free_bytes_(request.free_bytes) {}

  std::vector<std::vector<ImageF>> Generate(const ViewRequest& request, const Listener& listener) const override {
    NetworkSet networks = model_.networks();
    networks.free_bytes = free_bytes_;
    return Generator(networks, options_, listener).Generate(request);
  }

 private:
  Model model_;
  SevaOptions options_;
  int64_t free_bytes_;
};

}  // namespace

struct Model::State {
  SevaFiles files;
  Placement placement;
  VaeConfig vae_config;
  OpenClipConfig clip_config;
  Unet unet;
  std::optional<Vae> vae;
  std::optional<OpenClip> clip;

  Autocast Products() const { return {placement.device, placement.products}; }

  /// Keeps on the device what works next. On the CPU everything stays: mapped files cost nothing.
  void Place(Component component) {
    const bool stays = placement.device.is_cpu();
    if (component == Component::kUnet && !stays) vae.reset();
    if (component != Component::kEncoder && !stays) clip.reset();
    if (component != Component::kUnet && !vae) vae = LoadVae(files.vae, vae_config, placement.device, placement.type);
    if (component == Component::kEncoder && !clip) {
      clip = LoadOpenClip(files.clip, clip_config, placement.device, placement.type);
    }
  }
};

Placement PlaceOn(torch::Device device, Precision precision) {
  switch (precision) {
    case Precision::kBFloat16:
      return {device, torch::kBFloat16, {}};
    case Precision::kFloat16:
      return {device, torch::kHalf, {}};
    case Precision::kAutocast:
      return {device, torch::kFloat, HalfTypeOf(device)};
    case Precision::kFloat32:
      break;
  }
  return {device, torch::kFloat, {}};
}

Model::Model(const SevaFiles& files, const Placement& placement) : state_(std::make_unique<State>()) {
  if (files.unet.empty()) throw ShapeError("Model: there is no file of the UNet");
  state_->files = files;
  state_->placement = placement;
  state_->vae_config = VaeConfigOf(files.vae);
  state_->clip_config = ClipConfigOf(files.clip);
  state_->unet = LoadUnet(files.unet, UnetConfigOf(files.unet.front()), placement);
  state_->Place(Component::kEncoder);  // so that faults of the files are reported now
  state_->Place(Component::kUnet);
  const int64_t wanted = state_->unet.config.context_width, given = state_->clip_config.output;
  if (wanted != given) {
    throw InputError("{}: gives embeddings of {} numbers and {} takes {}; get the weights again", files.clip.string(),
                     given, files.unet.front().string(), wanted);
  }
}

Model::~Model() = default;

NetworkSet Model::networks() const {
  State* state = state_.get();
  NetworkSet networks;
  networks.unet = &state->unet;
  networks.place = [state](Component component) { state->Place(component); };
  networks.encode = [state](const Tensor& image) {
    const Autocast scope = state->Products();
    return EncodeImages(*state->vae, image).to(torch::kFloat);
  };
  networks.decode = [state](const Tensor& latent, int64_t side) {
    const Autocast scope = state->Products();
    return DecodeTiled(*state->vae, latent, {side, std::max<int64_t>(1, side / 3)});
  };
  networks.embed = [state](const Tensor& image) {
    const Autocast scope = state->Products();
    return ImageEmbeddings(*state->clip, image);
  };
  networks.autoencoder = MemoryOf(state->files, state->vae_config, state->placement);
  networks.other_weights = OtherWeightsOf(state->files, state->placement);
  return networks;
}

std::unique_ptr<ViewGenerator> LoadViewGenerator(const ViewGeneratorRequest& request) {
  CheckOptions(request.options);
  return std::make_unique<LoadedGenerator>(request);
}

void RequireMemory(const ViewGeneratorRequest& request, Size photo) {
  if (request.free_bytes <= 0) return;
  const Placement placement = PlaceOn(ToTorch(request.device), request.options.precision);
  const AutoencoderMemory autoencoder = MemoryOf(request.files, VaeConfigOf(request.files.vae), placement);
  MemoryRequest memory{request.options.frames, WorkingSize(photo, request.options.short_side)};
  memory.type = placement.type;
  memory.other_weights = OtherWeightsOf(request.files, placement);
  memory.gpu = !placement.device.is_cpu();
  const UnetConfig config = UnetConfigOf(request.files.unet.front());
  ChooseHalves(config, memory, request.options, request.free_bytes);
  ChooseTile({memory.size, EstimateMemory(config, memory).weights, autoencoder}, request.free_bytes);
}

}  // namespace oraclegs::seva
