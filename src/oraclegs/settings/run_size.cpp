#include "oraclegs/settings/run_size.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "oraclegs/capture/photo_checks.h"
#include "oraclegs/settings/from_results.h"
#include "oraclegs/train/memory_estimate.h"

namespace oraclegs {
namespace {

/// Sizes of a quality on a device. Gaussians are for kUsualPixels.
struct Level {
  int max_size, iterations, max_gaussians;
};

constexpr double kUsualViewPixels = 0.75e6, kUsualPixels = 12 * kUsualViewPixels;  // twelve views of 1000 x 750
constexpr double kMaxIterationFactor = 1.25;
constexpr double kMaxGaussianFactor = 3;
// Least pixels of all photos for a Gaussian, times the number of photos. With fewer, Gaussians are left over that one
// photo alone holds in place: three photos of 250 x 190 are shown best by 15 000, twelve of
// 135 x 240 by 100 000.
constexpr double kPixelsOfGaussian = 30;
constexpr int kGaussianStep = 5000;   // makes round numbers
constexpr int kFewViews = 8;          // with fewer views long training overfits
constexpr double kShareOfGpu = 0.85;  // of its free memory; the rest is for what is not counted
constexpr int kLeastGaussiansOnGpu = 100000, kLeastSideOnGpu = 400;
constexpr double kShrink = 0.85;
constexpr int kMinIterations = 1000, kIterationStep = 100;
constexpr int kDraftStereoPasses = 1;

Level LevelOf(Quality quality, bool on_gpu) {
  switch (quality) {
    case Quality::kDraft:
      return on_gpu ? Level{1000, 7000, 200000} : Level{500, 1000, 30000};
    case Quality::kHigh:
      return on_gpu ? Level{3200, 30000, 2000000} : Level{1600, 10000, 250000};
    default:
      return on_gpu ? Level{1600, 15000, 800000} : Level{1000, 2500, 100000};
  }
}

double PixelsOfView(const SceneSize& scene, const ImageOptions& image) {
  const PixelSize size = WorkingSize(scene.largest, image);
  return static_cast<double>(size.width) * size.height;
}

int Rounded(double value, int step) { return static_cast<int>(std::lround(value / step)) * step; }

/// More Gaussians for more pixels, and no more than the photos can hold in place.
int GaussiansFor(int views, double pixels_of_view, int usual) {
  const double pixels = views * pixels_of_view;
  const double wanted = std::clamp(std::sqrt(pixels / kUsualPixels), 1.0, kMaxGaussianFactor) * usual;
  return std::max(kGaussianStep, Rounded(std::min(wanted, pixels * views / kPixelsOfGaussian), kGaussianStep));
}

/// Shrinks what is automatic until it fits.
void FitToGpu(int64_t free, const SceneSize& scene, const RunOptions& asked, RunOptions* settled) {
  const auto fits = [&] {
    return static_cast<double>(GpuBytes(*settled, scene)) <= kShareOfGpu * static_cast<double>(free);
  };
  int gaussians = settled->train.max_gaussians.value();
  while (!fits() && asked.train.max_gaussians.is_auto() && gaussians > kLeastGaussiansOnGpu) {
    gaussians = std::max(kLeastGaussiansOnGpu, Rounded(kShrink * gaussians, kGaussianStep));
    settled->train.max_gaussians = gaussians;
  }
  int side = settled->image.max_size.value();
  const bool may_resize = asked.image.max_size.is_auto() && asked.image.downscale.is_auto();
  while (!fits() && may_resize && side > kLeastSideOnGpu) {
    side = std::max(kLeastSideOnGpu, static_cast<int>(kShrink * side));
    settled->image.max_size = side;
  }
}

/// More iterations for small images, which cost little; fewer for few views, which long training would overfit.
int IterationsFor(int views, double pixels_of_view, int usual) {
  const double small = std::clamp(std::sqrt(kUsualViewPixels / pixels_of_view), 1.0, kMaxIterationFactor);
  const double few = std::sqrt(std::min(1.0, static_cast<double>(views) / kFewViews));
  return std::max(kMinIterations, Rounded(small * few * usual, kIterationStep));
}

}  // namespace

SceneSize SizeOf(const Scene& scene, int training_views) {
  SceneSize size{training_views, {}};
  for (const SceneView& view : scene.views) {
    const PixelSize image{view.intrinsics.width, view.intrinsics.height};
    if (int64_t{image.width} * image.height > int64_t{size.largest.width} * size.largest.height) size.largest = image;
  }
  return size;
}

RunOptions WithSize(RunOptions options, const SceneSize& scene, const TrainingMachine& machine) {
  const RunOptions asked = options;
  const Level level = LevelOf(options.quality.quality, machine.is_gpu);
  if (options.image.max_size.is_auto()) options.image.max_size = options.image.downscale.is_auto() ? level.max_size : 0;
  if (options.train.iterations.is_auto()) {
    options.train.iterations =
        IterationsFor(scene.views, PixelsOfView(scene, options.image.Settled()), level.iterations);
    // Rates and weights follow their schedules over the horizon.
    if (options.train.horizon > 0) options.train.iterations = options.train.horizon;
  }
  if (options.train.max_gaussians.is_auto()) {
    options.train.max_gaussians =
        GaussiansFor(scene.views, PixelsOfView(scene, options.image.Settled()), level.max_gaussians);
  }
  const bool is_draft = options.quality.quality == Quality::kDraft;
  if (options.stereo.geometric_passes.is_auto())
    options.stereo.geometric_passes = is_draft ? kDraftStereoPasses : StereoOptions().geometric_passes;
  if (options.propose.proposers.is_auto()) {
    // From more photos, warps take a fifth of a draft's time, and on the mean of scenes teach it nothing.
    const bool does_without = scene.views >= kLeastPhotosAlone && options.propose.generator.empty();
    const char* of_draft = does_without ? kNoneWord : kWarpWord;
    options.propose.proposers = std::string(is_draft ? of_draft : kProxiesWord);
  }
  if (machine.is_gpu && machine.free_bytes > 0) FitToGpu(machine.free_bytes, scene, asked, &options);
  return options;
}

int64_t GpuBytes(const RunOptions& settled, const SceneSize& scene) {
  // As RasterCore::EstimateBytes has it, of three tiles a Gaussian, and the images of the losses and of a render.
  constexpr int64_t kRasterOfGaussian = 260, kWorkOfPixel = 160;
  constexpr int64_t kPhotoOfPixel = 22, kProposalOfPixel = 4;
  const auto pixels = static_cast<int64_t>(PixelsOfView(scene, settled.image.Settled()));
  const int64_t proposals = settled.propose.Words().empty() ? 0 : settled.trajectory.proposals.ValueOr(kMostProposals);
  return settled.train.max_gaussians.value() *
             (ModelBytes(settled.train.sh_moments) + kTrainScratchBytes + kRasterOfGaussian) +
         pixels * (kWorkOfPixel + kPhotoOfPixel * scene.views + kProposalOfPixel * proposals);
}

RunOptions WithUsualSizes(RunOptions options) {
  options.train.iterations = options.train.iterations.ValueOr(kUsualIterations);
  options.train.max_gaussians = options.train.max_gaussians.ValueOr(kUsualMaxGaussians);
  if (options.image.max_size.is_auto()) options.image.max_size = 0;
  options.propose.proposers = options.propose.proposers.ValueOr(kProxiesWord);
  if (options.split.test_every.is_auto() && options.split.test_views.empty()) options.split.eval = true;
  return options;
}

nlohmann::json SizeToJson(const RunOptions& settled) {
  nlohmann::json size = {{"max-size", settled.image.max_size.ValueOr(0)},
                         {"iterations", settled.train.iterations.ValueOr(kUsualIterations)},
                         {"max-gaussians", settled.train.max_gaussians.ValueOr(kUsualMaxGaussians)},
                         {"stereo-passes", settled.stereo.Settled().geometric_passes},
                         {"proposers", settled.propose.proposers.ValueOr(kProxiesWord)},
                         {"frames", settled.capture.frames.ValueOr(kUsualFrames)}};
  // Experiments settle sizes before any photo is read; their runs look at the photos.
  if (!settled.image.background.is_auto()) size["background"] = Word(settled.image.background.value());
  return size;
}

RunOptions WithSavedSize(RunOptions options, const nlohmann::json& size) {
  const auto take = [&size](const char* name, Auto<int>* option) {
    if (option->is_auto() && size.contains(name) && size.at(name).is_number_integer())
      *option = size.at(name).get<int>();
  };
  if (!size.is_object()) return options;
  take("max-size", &options.image.max_size);
  take("iterations", &options.train.iterations);
  take("max-gaussians", &options.train.max_gaussians);
  take("stereo-passes", &options.stereo.geometric_passes);
  take("frames", &options.capture.frames);
  const nlohmann::json background = size.value("background", nlohmann::json());
  if (options.image.background.is_auto() && background.is_string()) {
    if (const auto word = FromWord<Background>(background.get<std::string>())) options.image.background = *word;
  }
  const nlohmann::json proposers = size.value("proposers", nlohmann::json());
  if (options.propose.proposers.is_auto() && proposers.is_string()) {
    const std::vector<std::string> known = ProposerWords();
    const auto word = std::find(known.begin(), known.end(), proposers.get<std::string>());
    if (word != known.end()) options.propose.proposers = *word;
  }
  return options;
}

RunOptions WithBackground(RunOptions options, const Scene& scene) {
  if (!options.image.background.is_auto()) return options;
  std::vector<std::filesystem::path> photos;
  bool has_masks = !options.masks.masks.empty();
  for (const SceneView& view : scene.views) {
    photos.push_back(view.image_path);
    has_masks |= !view.mask_path.empty();
  }
  options.image.background = !has_masks && AreOnWhite(photos) ? Background::kWhite : Background::kBlack;
  return options;
}

int SettleFrames(const RunOptions& options, const nlohmann::json& saved_size) {
  return WithSavedSize(options, saved_size).capture.frames.ValueOr(kUsualFrames);
}

std::string DescribeSize(const RunOptions& asked, const RunOptions& settled, const SceneSize& scene) {
  std::vector<std::string> parts;
  const PixelSize size = WorkingSize(scene.largest, settled.image.Settled());
  if (size != scene.largest && asked.image.max_size.is_auto() && asked.image.downscale.is_auto()) {
    parts.push_back(fmt::format("photos of {}x{} are used at {}x{} (--max-size {})", scene.largest.width,
                                scene.largest.height, size.width, size.height, settled.image.max_size.value()));
  }
  if (asked.image.background.is_auto() && settled.image.background == Background::kWhite)
    parts.emplace_back("a white background (--background)");
  if (asked.train.iterations.is_auto()) parts.push_back(fmt::format("{} iterations", settled.train.iterations.value()));
  if (asked.train.max_gaussians.is_auto()) {
    parts.push_back(fmt::format("at most {} Gaussians", settled.train.max_gaussians.value()));
  }
  if (parts.empty()) return "";
  return fmt::format("{}; --quality {}", fmt::join(parts, ", "), Word(settled.quality.quality));
}

}  // namespace oraclegs
