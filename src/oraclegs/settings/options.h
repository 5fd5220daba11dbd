#pragma once
// Every option of a run, in groups. Each group lists its fields once (core/options.h).

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "oraclegs/baselines/settings.h"
#include "oraclegs/capture/import.h"
#include "oraclegs/core/options.h"
#include "oraclegs/image/image.h"
#include "oraclegs/networks/seva_options.h"
#include "oraclegs/propose/options.h"
#include "oraclegs/propose/trajectory.h"
#include "oraclegs/scene/frame.h"
#include "oraclegs/scene/split.h"
#include "oraclegs/settings/image_options.h"
#include "oraclegs/settings/stereo_options.h"
#include "oraclegs/train/options.h"
#include "oraclegs/validate/options.h"

namespace oraclegs {

/// Method that finds the cameras of images without poses.
enum class PoseSource { kColmap, kVggt };
template <>
struct EnumWords<PoseSource> {
  static constexpr EnumWord<PoseSource> kWords[] = {{PoseSource::kColmap, "colmap"}, {PoseSource::kVggt, "vggt"}};
};

/// Whether poses are corrected by what the photos show.
enum class PoseRefining { kOn, kOff };
template <>
struct EnumWords<PoseRefining> {
  static constexpr EnumWord<PoseRefining> kWords[] = {{PoseRefining::kOn, "on"}, {PoseRefining::kOff, "off"}};
};

/// Source of the initial Gaussians.
enum class StartKind { kDense, kSfm, kRandom, kRandomCube, kHybrid };
template <>
struct EnumWords<StartKind> {
  static constexpr EnumWord<StartKind> kWords[] = {{StartKind::kDense, "dense"},
                                                   {StartKind::kSfm, "sfm"},
                                                   {StartKind::kRandom, "random"},
                                                   {StartKind::kRandomCube, "random-cube"},
                                                   {StartKind::kHybrid, "hybrid"}};
};

/// Source of the sparse points.
enum class SfmPoints { kTriangulate, kModel };
template <>
struct EnumWords<SfmPoints> {
  static constexpr EnumWord<SfmPoints> kWords[] = {{SfmPoints::kTriangulate, "triangulate"},
                                                   {SfmPoints::kModel, "model"}};
};

/// Source of the training views' depth.
enum class DepthPrior { kMonocular, kStereo, kFused, kNone, kSensor };
template <>
struct EnumWords<DepthPrior> {
  static constexpr EnumWord<DepthPrior> kWords[] = {{DepthPrior::kMonocular, "depth-anything"},
                                                    {DepthPrior::kStereo, "stereo"},
                                                    {DepthPrior::kFused, "fused"},
                                                    {DepthPrior::kSensor, "sensor"},
                                                    {DepthPrior::kNone, "none"}};
};

enum class LpipsUse { kWhereFound, kRequired };
template <>
struct EnumWords<LpipsUse> {
  static constexpr EnumWord<LpipsUse> kWords[] = {{LpipsUse::kWhereFound, "auto"}, {LpipsUse::kRequired, "required"}};
};

struct InputOptions {
  std::filesystem::path images;  ///< empty = the format's usual folder
  bool allow_outside = false;    ///< allows images outside the scene's folder
  PoseSource poses = PoseSource::kColmap;
  FrameKind frame = FrameKind::kNormal;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("images", self.images, "Folder of the photos, where it is not the scene's usual one");
    visit("allow-outside", self.allow_outside,
          "Also read images and masks that the scene's files name outside its folder; for scenes that you trust");
    visit("poses", self.poses,
          "What finds the cameras of photos without poses: colmap = structure from motion; vggt = the network, in one "
          "pass, also from photos that share too little for colmap");
    visit(
        "frame", self.frame,
        "What a scene with poses is trained in: normal = moved and scaled so that the result does not depend on the "
        "scene's units and origin, and written back in the scene's own; scene = the scene's own, as published programs "
        "do, whose constants are of scenes of a few units",
        Tier::kSetting);
  }
};

/// Options about the scene's poses. They may become known, or change, after a run.
struct FrameOptions {
  std::string scale;   ///< text for UnitMeters
  bool force = false;  ///< trains even with given poses that the photos contradict

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit(
        "scale", self.scale,
        "A length that you know, as IMG_1,IMG_2=0.35: these two photos were taken 0.35 m apart; for scenes with poses "
        "also the meters of a unit. Without it, by GPS where EXIF has it. Exports and meshes are in meters then");
    visit("force", self.force, "Train even with given poses that hardly any match between the photos fits");
  }
};

/// Time that a run may take for its result.
enum class Quality { kDraft, kNormal, kHigh };
template <>
struct EnumWords<Quality> {
  static constexpr EnumWord<Quality> kWords[] = {
      {Quality::kDraft, "draft"}, {Quality::kNormal, "normal"}, {Quality::kHigh, "high"}};
};

/// Main control: --max-size, --iterations, --max-gaussians and --proposers follow it where they are automatic.
struct QualityOptions {
  Quality quality = Quality::kNormal;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("quality", self.quality,
          "Size, iterations, Gaussians and proposals, unless other options set them: draft = a first look within "
          "minutes; "
          "normal; high = the most detail, for much longer. A run can go on to a higher one");
  }
};

struct StartOptions {
  Auto<SfmPoints> sfm_points;
  Auto<StartKind> init;
  Auto<double> init_scale;
  double init_opacity = 0.5;
  bool init_planes = true;
  uint64_t seed = 0;
  std::filesystem::path init_points = {};

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit(
        "sfm-points", self.sfm_points,
        "Where sparse points come from: triangulate = by colmap from the training views alone, with their poses fixed; "
        "model = of the scene's own those that two training views saw; auto = model where all photos train",
        Tier::kSetting);
    visit("init", self.init,
          "Where the Gaussians start: dense = points of multi-view stereo, sfm = points triangulated from the training "
          "views, random = in the volume they look at, random-cube = as 3DGS-MCMC's authors draw them, in a cube of "
          "thrice the cameras' extent around the origin, hybrid = the first three, auto = dense, or sfm joined by "
          "random points where stereo finds little, or random alone below 100");
    visit("init-scale", self.init_scale,
          "Initial scale as a factor of the distance to the neighbors; auto = 1 for a dense start, 0.1 for others",
          Range{1e-6, 10}, Tier::kSetting);
    visit("init-opacity", self.init_opacity, "Initial opacity", Range{0.006, 0.99}, Tier::kSetting);
    visit("init-points", self.init_points,
          "A PLY of points that the Gaussians start from in place of --init (there, too)", Tier::kSetting);
    visit("init-planes", self.init_planes, "Extend fitted planes into walls and lawns where stereo finds nothing",
          Tier::kSetting);
    visit("seed", self.seed, "Seed of all random numbers; the same seed gives the same bits",
          Range{0, 9007199254740992.0});
  }
};

struct DepthOptions {
  Auto<DepthPrior> depth_prior;
  std::filesystem::path depth_folder;
  Auto<PoseRefining> refine_poses;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("depth-prior", self.depth_prior,
          "Source of the photos' depth: stereo; sensor = a sensor's, which the scene's files name, and stereo; "
          "depth-anything = a network's of each photo, aligned to the sparse points; fused = stereo where confident, "
          "else the network's, warped to fit; auto = sensor where half of the photos have one, fused where the "
          "network's weights are, else stereo; none = no depth: a sparse start, only a generator's proposals");
    visit("depth-folder", self.depth_folder,
          "Folder of your own depth of the training views (docs/formats.md#depth-and-points-of-your-own)",
          Tier::kSetting);
    visit("refine-poses", self.refine_poses,
          "Correct the photos' poses by what dense stereo sees, patches beside their epipolar lines; auto = where they "
          "lie a quarter of a pixel beside them, or those of one photo half a pixel");
  }
};

/// Device that computes; up to rounding the result is the same. May differ when a run is continued.
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

/// Options that change the speed of a run, but not one bit of its result; they may differ when a run is continued.
struct MachineOptions {
  int threads = 0;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("threads", self.threads, "Threads to compute with, 0 = all cores", Range{0, 4096});
  }
};

/// Limits of what files may ask of the machine; they may differ when a run is continued.
struct FileLimits {
  int max_megapixels = kUsualMaxMegapixels;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("max-megapixels", self.max_megapixels,
          "Largest image file that is read, in million pixels. A file of some kilobytes can promise as many, and each "
          "pixel takes up to 16 bytes of memory: lower it for files of strangers",
          Range{1, kLargestMaxMegapixels});
  }
};

/// Times at which a run that trains writes checkpoints and scores; they may differ when a run is continued.
struct CheckpointSchedule {
  int checkpoint_every = 1000;
  int eval_every = 0;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("checkpoint-every", self.checkpoint_every,
          "Iterations between checkpoints, from which a killed run continues; 0 = only when interrupted",
          Range{0, 1e7});
    visit(
        "eval-every", self.eval_every,
        "Iterations between scores of the test views, the column psnr of train.csv; each one renders all of them; 0 = "
        "none",
        Range{0, 1e7});
  }
};

/// Output for people at the end of a run. May differ when a run is continued.
struct ReportOptions {
  bool report = true;
  int orbit_frames = 96;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("report", self.report, "End with report.html, which shows the splat, the scores and the proposals");
    visit("orbit-frames", self.orbit_frames,
          "Images of the film of four seconds that the report begins with, when ffmpeg is installed; 0 = none",
          Range{0, 1000}, Tier::kSetting);
  }
};

/// Files of weights on this machine, and replacements for missing ones. The results of a stage depend on their content,
/// which is part of its key.
struct WeightOptions {
  bool allow_fallback = false;
  LpipsUse lpips = LpipsUse::kWhereFound;
  std::filesystem::path depth_weights;
  std::filesystem::path lpips_weights;
  std::filesystem::path vggt_weights;
  std::filesystem::path seva_weights;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("allow-fallback", self.allow_fallback,
          "Where weights of a network are missing that other options ask for, take what needs none, and say so");
    visit("lpips", self.lpips,
          "LPIPS in the proposals' loss and among the scores: auto = where its weights are; required = an error where "
          "they are not");
    visit("depth-weights", self.depth_weights,
          "File of Depth Anything V2's weights, S, B or L (safetensors), where it is not the one that `oraclegs models "
          "fetch depth-anything-v2-small` brings");
    visit("lpips-weights", self.lpips_weights,
          "File of LPIPS's weights, with VGG16 or AlexNet (safetensors), where it is not the one that `oraclegs models "
          "fetch lpips-vgg` brings");
    visit("vggt-weights", self.vggt_weights,
          "File of VGGT's weights (safetensors), where it is not the one that `oraclegs models fetch vggt` brings");
    visit("seva-weights", self.seva_weights,
          "File of Stable Virtual Camera's weights (safetensors), where it is not the one that `oraclegs models fetch "
          "seva` brings: version 1.0, for example (seva-1.0)",
          Tier::kSetting);
  }
};

struct RunOptions {
  InputOptions input;
  MaskOptions masks;
  FrameOptions frame;
  QualityOptions quality;
  CaptureOptions capture;  ///< for commands that start a run; not in the groups below
  SplitOptions split;
  AutoImageOptions image;
  StartOptions start;
  AutoStereoOptions stereo;
  DepthOptions depth;
  TrajectoryOptions trajectory;
  ProposeOptions propose;
  SevaOptions seva;
  ValidateOptions validate;
  AutoTrainOptions train;
  MethodOptions method;
  GeneratorLimits generator_limits;
  CheckpointSchedule checkpoints;
  ReportOptions report;
  WeightOptions weights;
  DeviceOptions device;
  MachineOptions machine;
  FileLimits file_limits;

  /// Calls f("Group title", group) for the groups whose options shape the result.
  template <class Self, class F>
  static void ForEachShapingGroup(Self& self, F&& f) {
    f("Scene", self.input);
    f("Scene", self.masks);
    f("Basic", self.quality);
    f("Split", self.split);
    f("Images", self.image);
    f("Start", self.start);
    f("Stereo", self.stereo);
    f("Depth", self.depth);
    f("Proposed poses", self.trajectory);
    f("Proposals", self.propose);
    f("Stable Virtual Camera", self.seva);
    f("Validation", self.validate);
    f("Training", self.train);
    f("Training", self.method);
  }
  template <class Self, class F>
  static void ForEachGroup(Self& self, F&& f) {
    ForEachShapingGroup(self, f);
    f("Scene", self.frame);
    f("Proposals", self.generator_limits);
    f("Checkpoints", self.checkpoints);
    f("Report", self.report);
    f("Weights", self.weights);
    f("Machine", self.device);
    f("Machine", self.machine);
    f("Machine", self.file_limits);
  }
};

/// {"views": 12, ...} of the options that shape the result.
nlohmann::json ShapingOptionsToJson(const RunOptions& options);

/// {"views": 12, ...} of all options.
nlohmann::json RunOptionsToJson(const RunOptions& options);

/// Throws UsageError for the first option out of its range, for --set vggt-layers and --set vggt-layer-weights that are
/// no layers and weights, and where --proposers and --generator contradict each other.
void CheckRunOptions(const RunOptions& options);

}  // namespace oraclegs
