#pragma once
// Every option of a run, in groups. Each group lists its fields once (core/options.h).

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "oraclegs/core/options.h"
#include "oraclegs/depth/stereo.h"
#include "oraclegs/networks/seva/options.h"
#include "oraclegs/propose/options.h"
#include "oraclegs/propose/trajectory.h"
#include "oraclegs/scene/loaded_view.h"
#include "oraclegs/scene/split.h"
#include "oraclegs/train/options.h"
#include "oraclegs/validate/options.h"

namespace oraclegs {

struct InputOptions {
  std::filesystem::path images;  ///< empty = where the format usually has it
  std::string poses = "colmap";

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("images", self.images, "Folder of the photographs, where it is not the scene's usual one");
    visit("poses", self.poses,
          "Who finds the cameras of photographs without poses: colmap = structure from motion; vggt = the network, in "
          "one pass, also from photographs that share too little for colmap",
          Choice{{"colmap", "vggt"}});
  }
};

struct StartOptions {
  std::string init = "auto";
  double init_scale = 0;
  double init_opacity = 0.5;
  double init_flatness = 1;
  std::string init_planes = "yes";
  uint64_t seed = 0;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("init", self.init,
          "Where the Gaussians start: dense = what stereo found, sfm = points triangulated from the training views, "
          "random = in the volume they look at, hybrid = all three, auto = dense, or sfm joined by random points "
          "where stereo finds little, or random alone below 100",
          Choice{{"auto", "dense", "sfm", "random", "hybrid"}});
    visit("init-scale", self.init_scale,
          "Start scale as a factor of the distance to the neighbours; 0 = 1 for a dense start, "
          "0.1 for others",
          Range{0, 10});
    visit("init-opacity", self.init_opacity, "Start opacity", Range{0.006, 0.99});
    visit("init-flatness", self.init_flatness,
          "Start thickness along the surface's normal, as a share of the other two scales; "
          "1 = round",
          Range{0.01, 1});
    visit("init-planes", self.init_planes,
          "A dense start also where stereo finds nothing, as far as the planes beside go on there (lawns, plain walls)",
          Choice{{"yes", "no"}});
    visit("seed", self.seed, "Seed of everything random; the same seed gives the same bits", Range{0, 9007199254740992.0});
  }
};

struct DepthOptions {
  std::string depth_prior = "auto";

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("depth-prior", self.depth_prior,
          "Where the photographs' depth comes from: stereo; depth-anything = a network's guess from each photograph "
          "alone, aligned to the sparse points; fused = stereo where it is sure, elsewhere the network's, bent to "
          "stereo; auto = fused where the network's weights are, else stereo; none = no depth, which leaves a sparse "
          "start and no views to propose",
          Choice{{"auto", "depth-anything", "stereo", "fused", "none"}});
  }
};

/// Which device computes; up to rounding the result is the same. Free to differ when a run is continued.
struct DeviceOptions {
  std::string device = "auto";  ///< see ChooseDevice

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit(
        "device", self.device,
        "What trains and renders: auto = an NVIDIA GPU when this program and the machine have one, else the CPU; cpu; "
        "cuda = that GPU or an error; cuda:N = the GPU of this number, from 0");
  }
};

/// What changes how fast a run goes, but not one bit of its result: free to differ when a run is continued.
struct MachineOptions {
  int threads = 0;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("threads", self.threads, "Threads to compute with, 0 = all cores", Range{0, 4096});
  }
};

/// Likewise.
struct CheckpointSchedule {
  int checkpoint_every = 1000;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("checkpoint-every", self.checkpoint_every,
          "Iterations between checkpoints, from which a killed run continues; 0 = only when interrupted",
          Range{0, 1e7});
  }
};

/// Where weights lie on this machine, and what to do without. What a stage makes depends on their content, which its
/// key holds.
struct WeightOptions {
  bool allow_fallback = false;
  std::string lpips = "auto";
  std::filesystem::path depth_weights;
  std::filesystem::path lpips_weights;
  std::filesystem::path vggt_weights;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("allow-fallback", self.allow_fallback,
          "Where weights of a network are missing that other options ask for, take what needs none, and say so");
    visit("lpips", self.lpips,
          "LPIPS in the proposals' loss and among the scores: auto = where its weights are; required = an error where "
          "they are not",
          Choice{{"auto", "required"}});
    visit("depth-weights", self.depth_weights,
          "File of Depth Anything V2's weights, S, B or L (safetensors), where it is not the one that `oraclegs models "
          "fetch depth-anything-v2-small` brings");
    visit("lpips-weights", self.lpips_weights,
          "File of LPIPS's weights, with VGG16 or AlexNet (safetensors), where it is not the one that `oraclegs models "
          "fetch lpips-vgg` brings");
    visit("vggt-weights", self.vggt_weights,
          "File of VGGT's weights (safetensors), where it is not the one that `oraclegs models fetch vggt` brings");
  }
};

struct RunOptions {
  InputOptions input;
  SplitOptions split;
  ImageOptions photo;
  StartOptions start;
  StereoOptions stereo;
  DepthOptions depth;
  TrajectoryOptions trajectory;
  ProposeOptions propose;
  SevaOptions seva;
  ValidateOptions validate;
  TrainOptions train;
  CheckpointSchedule checkpoints;
  WeightOptions weights;
  DeviceOptions device;
  MachineOptions machine;

  /// Calls f("Group title", group) for the groups whose options shape the result.
  template <class F>
  void ForEachShapingGroup(F&& f) {
    f("Scene", input);
    f("Split", split);
    f("Photographs", photo);
    f("Start", start);
    f("Stereo", stereo);
    f("Depth", depth);
    f("Proposed poses", trajectory);
    f("Proposals", propose);
    f("Stable Virtual Camera", seva);
    f("Validation", validate);
    f("Training", train);
  }
  template <class F>
  void ForEachGroup(F&& f) {
    ForEachShapingGroup(f);
    f("Checkpoints", checkpoints);
    f("Weights", weights);
    f("Machine", device);
    f("Machine", machine);
  }
};

/// {"views": 12, ...} of the options that shape the result.
inline nlohmann::json ShapingOptionsToJson(const RunOptions& options) {
  nlohmann::json json = nlohmann::json::object();
  const_cast<RunOptions&>(options).ForEachShapingGroup(
      [&](const char*, const auto& group) { json.update(OptionsToJson(group)); });
  return json;
}

/// The same of all options.
inline nlohmann::json RunOptionsToJson(const RunOptions& options) {
  nlohmann::json json = ShapingOptionsToJson(options);
  json.update(OptionsToJson(options.checkpoints));
  json.update(OptionsToJson(options.weights));
  json.update(OptionsToJson(options.device));
  json.update(OptionsToJson(options.machine));
  return json;
}

/// Throws UsageError for the first option out of its range.
inline void CheckRunOptions(const RunOptions& options) {
  const_cast<RunOptions&>(options).ForEachGroup([](const char*, const auto& group) { CheckOptions(group); });
}

}  // namespace oraclegs
