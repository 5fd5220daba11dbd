#include "oraclegs/weights/registry.h"

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

const std::string kTorchvision = "https://download.pytorch.org/models/";
const std::string kLpips =
    "https://raw.githubusercontent.com/richzhang/PerceptualSimilarity/082bb24f84c091ea94de2867d34c4544f68e0963/lpips/"
    "weights/v0.1/";

const std::string kAliked =
    "https://raw.githubusercontent.com/Shiaoming/ALIKED/683d7c65197395c0b3f01ebe76e1084a27e73a65/models/";

std::string PageOnHub(const std::string& repository) { return fmt::format("{}{}", kHuggingFace, repository); }

/// A file as it was at one revision, which never changes: "OWNER/NAME", "REVISION", "PATH".
PublishedFile OnHub(const std::string& repository, const std::string& revision, const std::string& path,
                    const std::string& sha256 = {}, uint64_t bytes = 0) {
  return {fmt::format("{}/resolve/{}/{}", PageOnHub(repository), revision, path), sha256, bytes};
}

WeightsInfo DepthAnythingV2Model(const std::string& size, const std::string& purpose, const std::string& license,
                                 const PublishedFile& file) {
  WeightsInfo model;
  model.name = model.parameters = "depth-anything-v2-" + size;
  model.purpose = purpose;
  model.license = license;
  model.non_commercial = license != "Apache-2.0";
  model.license_page = file.url.substr(0, file.url.find("/resolve/"));
  model.files = {file};
  model.download_bytes = file.bytes;
  return model;
}

std::vector<WeightsInfo> DepthModels() {
  return {
      DepthAnythingV2Model("small", "depth prior (the default)", "Apache-2.0",
                           OnHub("depth-anything/Depth-Anything-V2-Small", "03876f8651c73a60fe4c2c48294e09fcb6838fcf",
                                 "depth_anything_v2_vits.pth",
                                 "715fade13be8f229f8a70cc02066f656f2423a59effd0579197bbf57860e1378", 99'218'434)),
      DepthAnythingV2Model("base", "depth prior", "CC-BY-NC-4.0",
                           OnHub("depth-anything/Depth-Anything-V2-Base", "a4e71a6c2ce52fe50df0f212066b0d4a87be9b5e",
                                 "depth_anything_v2_vitb.pth",
                                 "0d2b7002e62d39d655571c371333340bd88f67ab95050c03591555aa05645328", 389'961'218)),
      DepthAnythingV2Model("large", "depth prior", "CC-BY-NC-4.0",
                           OnHub("depth-anything/Depth-Anything-V2-Large", "cbbb86a30ce19b5684b7a05155dc7e6cbc7685b9",
                                 "depth_anything_v2_vitl.pth",
                                 "a7ea19fa0ed99244e67b624c72b8580b7e9553043245905be58796a608eb9345", 1'341'395'338))};
}

std::vector<WeightsInfo> VggtModels() {
  WeightsInfo research;
  research.name = research.parameters = "vggt";
  research.purpose = "3D-aware oracle, poses (VGGT-1B)";
  research.license = "CC-BY-NC-4.0";
  research.license_page = PageOnHub("facebook/VGGT-1B");
  research.non_commercial = true;
  research.files = {OnHub("facebook/VGGT-1B", "860abec7937da0a4c03c41d3c269c366e82abdf9", "model.safetensors",
                          "f164acf60724910d8fe1578bb499d800850c7bb0948db7555c413f9fbe60467e", 5'026'367'224)};
  research.convert = false;
  research.download_bytes = 5'026'367'224;

  WeightsInfo commercial = research;
  commercial.name = "vggt-commercial";
  commercial.purpose = "the same, trained for commercial use (VGGT-1B-Commercial)";
  commercial.license = "VGGT License";
  commercial.license_page = PageOnHub("facebook/VGGT-1B-Commercial");
  commercial.non_commercial = false;
  commercial.restriction = "its acceptable use policy rules out military use, among others";
  commercial.gated = true;
  commercial.files = {
      OnHub("facebook/VGGT-1B-Commercial", "ebb29a532abe92960eeb6903a5530f16990ef4ab", "model.safetensors")};
  return {research, commercial};
}

WeightsInfo LpipsModel(const std::string& network, const PublishedFile& features, const PublishedFile& weights) {
  WeightsInfo model;
  model.name = model.parameters = "lpips-" + network;
  model.purpose = network == "vgg" ? "perceptual loss and score (LPIPS, VGG16)" : "perceptual score (LPIPS, AlexNet)";
  model.license = "BSD-3-Clause (torchvision), BSD-2-Clause (LPIPS)";
  model.license_page = "https://github.com/richzhang/PerceptualSimilarity/blob/master/LICENSE";
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

std::vector<WeightsInfo> KeypointModels() {
  WeightsInfo aliked;
  aliked.name = aliked.parameters = "aliked-n16";
  aliked.purpose = "keypoints and descriptors of photos (ALIKED)";
  aliked.license = "BSD-3-Clause";
  aliked.license_page = "https://github.com/Shiaoming/ALIKED/blob/main/LICENSE";
  aliked.files = {
      {kAliked + "aliked-n16.pth", "5be8704840ed662d9d8c561bf7279c222092674e7eb05fd0feab94899e9d82f2", 2'738'091}};
  aliked.download_bytes = 2'738'091;
  return {aliked};
}

std::vector<WeightsInfo> GeneratorModels() {
  WeightsInfo seva;
  seva.name = seva.parameters = "seva";
  seva.purpose = "generator of proposals (Stable Virtual Camera 1.1)";
  seva.license = "Stability AI Non-Commercial License";
  seva.license_page = PageOnHub("stabilityai/stable-virtual-camera");
  seva.non_commercial = true;
  seva.restriction = "it covers the images that the network makes, too";
  seva.gated = true;
  seva.files = {OnHub("stabilityai/stable-virtual-camera", "e538e251c1009e9a41cf8b7fee5f21332a1960de",
                      "modelv1.1.safetensors", "b45d13cb89fe652d607c31989e5f71c2f1217a4f0939301fb60f3b941d6636da")};
  seva.convert = false;
  seva.download_bytes = 5'056'000'000;

  WeightsInfo first = seva;  // its checksum is of one source only, not of its authors
  first.name = "seva-1.0";
  first.purpose = "the same, version 1.0, as the paper's authors load it (--set seva-weights)";
  first.files = {OnHub("stabilityai/stable-virtual-camera", "e538e251c1009e9a41cf8b7fee5f21332a1960de",
                       "model.safetensors", "10e69ea003c313e6bdfc7ee40376d1c19ea6036c20bd384e94b483dec8350396")};

  // Stable Diffusion 2.1 is no longer open to everybody; its authors publish the same autoencoder, byte by byte, here.
  WeightsInfo vae;
  vae.name = vae.parameters = "sd21-vae";
  vae.purpose = "images to latents and back, for seva";
  vae.license = "MIT";
  vae.license_page = PageOnHub("stabilityai/sd-vae-ft-mse");
  vae.files = {OnHub("stabilityai/sd-vae-ft-mse", "31f26fdeee1355a5c34592e401dd41e45d25a493",
                     "diffusion_pytorch_model.safetensors",
                     "a1d993488569e928462932c8c38a0760b874d166399b14414135bd9c42df5815", 334'643'276)};
  vae.download_bytes = 334'643'276;

  WeightsInfo clip;
  clip.name = clip.parameters = "openclip-vith14";
  clip.purpose = "embedding of an image, for seva (OpenCLIP ViT-H/14)";
  clip.license = "MIT";
  clip.license_page = PageOnHub("laion/CLIP-ViT-H-14-laion2B-s32B-b79K");
  clip.files = {OnHub("laion/CLIP-ViT-H-14-laion2B-s32B-b79K", "1c2b8495b28150b8a4922ee1c8edee224c284c0c",
                      "open_clip_pytorch_model.bin", "9a78ef8e8c73fd0df621682e7a8e8eb36c6916cb3c16b291a082ecd52ab79cc4",
                      3'944'692'325)};
  clip.download_bytes = 3'944'692'325;
  return {seva, first, vae, clip};
}

}  // namespace

const std::vector<WeightsInfo>& AllWeights() {
  static const std::vector<WeightsInfo> kModels = [] {
    std::vector<WeightsInfo> all;
    for (const auto& group : {DepthModels(), VggtModels(), LpipsModels(), KeypointModels(), GeneratorModels()}) {
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
