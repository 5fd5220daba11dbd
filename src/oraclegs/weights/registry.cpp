#include "oraclegs/weights/registry.h"

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

const std::string kTorchvision = "https://download.pytorch.org/models/";
const std::string kLpips =
    "https://raw.githubusercontent.com/richzhang/PerceptualSimilarity/082bb24f84c091ea94de2867d34c4544f68e0963/lpips/"
    "weights/v0.1/";

PublishedFile OnHub(const std::string& repository, const std::string& path, const std::string& sha256 = {},
                    uint64_t bytes = 0) {
  return {std::string(kHuggingFace) + repository + "/resolve/main/" + path, sha256, bytes};
}

WeightsInfo DepthAnythingV2Model(const std::string& size, const std::string& purpose, const std::string& licence,
                                 const PublishedFile& file) {
  WeightsInfo model;
  model.name = model.parameters = "depth-anything-v2-" + size;
  model.purpose = purpose;
  model.licence = licence;
  model.non_commercial = licence != "Apache-2.0";
  model.licence_page = file.url.substr(0, file.url.find("/resolve/"));
  model.files = {file};
  model.download_bytes = file.bytes;
  return model;
}

std::vector<WeightsInfo> DepthModels() {
  return {
      DepthAnythingV2Model("small", "depth prior (the default)", "Apache-2.0",
                           OnHub("depth-anything/Depth-Anything-V2-Small", "depth_anything_v2_vits.pth",
                                 "715fade13be8f229f8a70cc02066f656f2423a59effd0579197bbf57860e1378", 99'218'434)),
      DepthAnythingV2Model("base", "depth prior", "CC-BY-NC-4.0",
                           OnHub("depth-anything/Depth-Anything-V2-Base", "depth_anything_v2_vitb.pth",
                                 "0d2b7002e62d39d655571c371333340bd88f67ab95050c03591555aa05645328", 389'961'218)),
      DepthAnythingV2Model("large", "depth prior", "CC-BY-NC-4.0",
                           OnHub("depth-anything/Depth-Anything-V2-Large", "depth_anything_v2_vitl.pth",
                                 "a7ea19fa0ed99244e67b624c72b8580b7e9553043245905be58796a608eb9345", 1'341'395'338))};
}

std::vector<WeightsInfo> VggtModels() {
  WeightsInfo research;
  research.name = research.parameters = "vggt";
  research.purpose = "3D-aware oracle, poses (VGGT-1B)";
  research.licence = "CC-BY-NC-4.0";
  research.licence_page = std::string(kHuggingFace) + "facebook/VGGT-1B";
  research.non_commercial = true;
  research.files = {OnHub("facebook/VGGT-1B", "model.safetensors")};
  research.convert = false;
  research.download_bytes = 5'026'000'000;

  WeightsInfo commercial = research;
  commercial.name = "vggt-commercial";
  commercial.purpose = "the same, trained for commercial use (VGGT-1B-Commercial)";
  commercial.licence = "VGGT License";
  commercial.licence_page = std::string(kHuggingFace) + "facebook/VGGT-1B-Commercial";
  commercial.non_commercial = false;
  commercial.restriction = "its acceptable use policy rules out military use, among others";
  commercial.gated = true;
  commercial.files = {OnHub("facebook/VGGT-1B-Commercial", "vggt_1B_commercial.pt")};
  commercial.convert = true;
  return {research, commercial};
}

WeightsInfo LpipsModel(const std::string& network, const PublishedFile& features, const PublishedFile& weights) {
  WeightsInfo model;
  model.name = model.parameters = "lpips-" + network;
  model.purpose = network == "vgg" ? "perceptual loss and score (LPIPS, VGG16)" : "perceptual score (LPIPS, AlexNet)";
  model.licence = "BSD-3-Clause (torchvision), BSD-2-Clause (LPIPS)";
  model.licence_page = "https://github.com/richzhang/PerceptualSimilarity/blob/master/LICENSE";
  model.files = {features, weights};
  model.download_bytes = features.bytes + weights.bytes;
  return model;
}

std::vector<WeightsInfo> LpipsModels() {
  return {LpipsModel("vgg",
                     {kTorchvision + "vgg16-397923af.pth",
                      "397923af8e79cdbb6a7127f12361acd7a2f83e06b05044ddf496e83de57a5bf0", 553'433'881},
                     {kLpips + "vgg.pth", "a78928a0af1e5f0fcb1f3b9e8f8c3a2a5a3de244d830ad5c1feddc79b8432868", 7'289}),
          LpipsModel("alex",
                     {kTorchvision + "alexnet-owt-7be5be79.pth",
                      "7be5be791159472b1fbf3c69796f7cb30dca7ad8466c2df70058c37116cdee02", 244'408'911},
                     {kLpips + "alex.pth", "df73285e35b22355a2df87cdb6b70b343713b667eddbda73e1977e0c860835c0", 6'009})};
}

std::vector<WeightsInfo> GeneratorModels() {
  WeightsInfo seva;
  seva.name = seva.parameters = "seva";
  seva.purpose = "generator of proposals (Stable Virtual Camera 1.1)";
  seva.licence = "Stability AI Non-Commercial License";
  seva.licence_page = std::string(kHuggingFace) + "stabilityai/stable-virtual-camera";
  seva.non_commercial = true;
  seva.restriction = "it covers the images that the network makes, too";
  seva.gated = true;
  seva.files = {OnHub("stabilityai/stable-virtual-camera", "modelv1.1.safetensors")};
  seva.convert = false;
  seva.download_bytes = 5'056'000'000;

  // Stable Diffusion 2.1 is no longer open to everybody; its authors publish the same autoencoder, byte by byte, here.
  WeightsInfo vae;
  vae.name = vae.parameters = "sd21-vae";
  vae.purpose = "images to latents and back, for seva";
  vae.licence = "MIT";
  vae.licence_page = std::string(kHuggingFace) + "stabilityai/sd-vae-ft-mse";
  vae.files = {OnHub("stabilityai/sd-vae-ft-mse", "diffusion_pytorch_model.safetensors",
                     "a1d993488569e928462932c8c38a0760b874d166399b14414135bd9c42df5815", 334'643'276)};
  vae.download_bytes = 334'643'276;

  WeightsInfo clip;
  clip.name = clip.parameters = "openclip-vith14";
  clip.purpose = "embedding of an image, for seva (OpenCLIP ViT-H/14)";
  clip.licence = "MIT";
  clip.licence_page = std::string(kHuggingFace) + "laion/CLIP-ViT-H-14-laion2B-s32B-b79K";
  clip.files = {OnHub("laion/CLIP-ViT-H-14-laion2B-s32B-b79K", "open_clip_pytorch_model.bin",
                      "9a78ef8e8c73fd0df621682e7a8e8eb36c6916cb3c16b291a082ecd52ab79cc4")};
  clip.download_bytes = 3'940'000'000;
  return {seva, vae, clip};
}

}  // namespace

const std::vector<WeightsInfo>& AllWeights() {
  static const std::vector<WeightsInfo> kModels = [] {
    std::vector<WeightsInfo> all;
    for (const auto& group : {DepthModels(), VggtModels(), LpipsModels(), GeneratorModels()}) {
      all.insert(all.end(), group.begin(), group.end());
    }
    return all;
  }();
  return kModels;
}

const WeightsInfo& WeightsNamed(const std::string& name) {
  std::vector<std::string> names;
  for (const WeightsInfo& model : AllWeights()) {
    if (model.name == name) return model;
    names.push_back(model.name);
  }
  throw UsageError("there is no model '{}', only: {}", name, fmt::join(names, ", "));
}

}  // namespace oraclegs
