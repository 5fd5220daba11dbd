#include "oraclegs/networks/seva/generator.h"

#include <algorithm>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "oraclegs/core/host.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/text.h"
#include "oraclegs/networks/common/tensor.h"
#include "oraclegs/networks/seva/chunk_store.h"
#include "oraclegs/networks/seva/conditioning.h"
#include "oraclegs/networks/seva/plan.h"
#include "oraclegs/networks/seva/sampler.h"

namespace oraclegs::seva {
namespace {

constexpr double kBytesInGigabyte = 1e9;

Eigen::Matrix3d Intrinsics(const Camera& camera) {
  Eigen::Matrix3d k;
  k << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1;
  return k;
}

View ViewOf(const Camera& camera, const ImageFit& fit) {
  return {camera.cam_from_world.inverse(), FittedIntrinsics(Intrinsics(camera), fit)};
}

Size SizeOf(const Camera& camera) { return {camera.width, camera.height}; }

/// Key of a stored chunk: the request's key and the options that change its images. The number of candidates and
/// --set seva-halves do not.
std::string KeyOf(const ViewRequest& request, const SevaOptions& options) {
  nlohmann::json json = OptionsToJson(options);
  for (const char* name : {"candidates", "seva-halves"}) json.erase(name);
  return request.key + " " + json.dump();
}

/// One generation: the views, the plan, and the images generated so far.
class Generation {
 public:
  Generation(const NetworkSet& networks, const SevaOptions& options, const ViewRequest& request,
             const Listener& listener)
      : networks_(networks),
        options_(options),
        listener_(listener),
        store_(request.workspace, KeyOf(request, options)),
        device_(networks.unet->any_weight().device()),
        schedule_(MakeSchedule()) {
    const std::vector<LoadedView>& views = *request.views;
    working_ = WorkingSize(SizeOf(views.front().camera), options.short_side);
    for (const LoadedView& view : views) AddInput(view);
    for (const Camera& target : request.targets) {
      target_fits_.push_back(FitImage(SizeOf(target), working_, FitMode::kPad));
      target_views_.push_back(ViewOf(target, target_fits_.back()));
    }
    all_views_ = input_views_;
    all_views_.insert(all_views_.end(), target_views_.begin(), target_views_.end());
    plan_ = MakePlan(input_views_, target_views_, options);
  }

  std::vector<std::vector<ImageF>> Run() {
    std::vector<std::vector<ImageF>> answers(target_views_.size());
    if (plan_.jobs.empty()) return answers;
    PlanMemory();
    CountSteps();
    for (int candidate = 0; candidate < options_.candidates; ++candidate) {
      made_.clear();
      for (size_t job = 0; job < plan_.jobs.size(); ++job) RunJob(candidate, job);
      for (size_t t = 0; t < answers.size(); ++t) {
        const FrameImage& image = made_.at({FrameSource::kTarget, static_cast<int64_t>(t)});
        answers[t].push_back(FromNetworkImage(FromWorkingSize(image.pixels, target_fits_[t])));
      }
    }
    return answers;
  }

 private:
  /// A frame whose pixels are known; its conditioning tensors are computed on first use.
  struct FrameImage {
    Tensor pixels;  ///< [1, 3, H, W]
    Tensor latent, embedding;
  };
  using FrameKey = std::pair<FrameSource, int64_t>;

  int64_t BytesToUse() const {
    if (networks_.free_bytes > 0) return networks_.free_bytes;
    const uint64_t free = AvailableMemory();
    return free > 0 ? static_cast<int64_t>(free) : std::numeric_limits<int64_t>::max();
  }

  void PlanMemory() {
    MemoryRequest memory{plan_.largest(), working_};
    memory.type = networks_.unet->any_weight().scalar_type();
    memory.other_weights = networks_.other_weights;
    memory.gpu = networks_.unet->any_weight().is_cuda();
    const int64_t bytes = BytesToUse(), weights = EstimateMemory(networks_.unet->config, memory).weights;
    halves_ = ChooseHalves(networks_.unet->config, memory, options_, bytes);
    memory.halves = halves_;
    listener_(Note{fmt::format("seva denoises {} frames of {} x {} at once, which needs about {:.3g} GB", memory.frames,
                               working_.width, working_.height,
                               Gigabytes(EstimateMemory(networks_.unet->config, memory).total()))});
    tile_ = ChooseTile({working_, weights, networks_.autoencoder}, bytes);
    if (tile_ * kLatentStride >= std::max(working_.width, working_.height)) return;
    listener_(Warning{
        fmt::format("seva's images are decoded in tiles of {} pixels, which differs a little from decoding them whole: "
                    "{:.1f} GB of memory are too few for that; a smaller --seva-short-side needs no tiles",
                    tile_ * kLatentStride, static_cast<double>(bytes) / kBytesInGigabyte)});
  }

  void AddInput(const LoadedView& photo) {
    const Size working = WorkingSize(SizeOf(photo.camera), options_.short_side);
    if (working.width != working_.width || working.height != working_.height) {
      throw InputError(
          "{}: seva would work on {} x {} pixels of it and on {} x {} of the first photo; give it "
          "photos of one shape",
          photo.name, working.width, working.height, working_.width, working_.height);
    }
    const ImageFit fit = FitImage(SizeOf(photo.camera), working_, FitMode::kCrop);
    input_views_.push_back(ViewOf(photo.camera, fit));
    inputs_.push_back({ToWorkingSize(ToNetworkImage(photo.rgb), fit), {}, {}});
  }

  FrameImage& FrameImageOf(const Frame& frame) {
    if (frame.source == FrameSource::kInput) return inputs_.at(static_cast<size_t>(frame.index));
    return made_.at({frame.source, frame.index});
  }

  const View& ViewAt(const Frame& frame) const {
    const auto index = static_cast<size_t>(frame.index);
    if (frame.source == FrameSource::kInput) return input_views_.at(index);
    return frame.source == FrameSource::kAnchor ? plan_.anchors.at(index) : target_views_.at(index);
  }

  static std::vector<Frame> MadeFrames(const Job& job) {
    std::vector<Frame> made;
    for (const Frame& frame : job.frames) {
      if (!frame.given && !frame.copy) made.push_back(frame);
    }
    return made;
  }

  std::optional<Tensor> Stored(int candidate, size_t job) const {
    const auto count = static_cast<int64_t>(MadeFrames(plan_.jobs[job]).size());
    return store_.Read(candidate, job, {count, 3, working_.height, working_.width});
  }

  /// Counts the steps left to do. Finished chunks are left out, since they would spoil the estimate of the time left.
  void CountSteps() {
    for (int candidate = 0; candidate < options_.candidates; ++candidate) {
      for (size_t job = 0; job < plan_.jobs.size(); ++job) {
        if (!Stored(candidate, job)) steps_total_ += options_.steps;
      }
    }
  }

  void Place(Component component) const {
    if (networks_.place) networks_.place(component);
  }

  void RunJob(int candidate, size_t index) {
    const Job& job = plan_.jobs[index];
    std::optional<Tensor> images = Stored(candidate, index);
    if (!images) {
      images = Decode(job, Sample(job, candidate, index));
      store_.Write(candidate, index, *images);
    }
    const std::vector<Frame> made = MadeFrames(job);
    for (size_t i = 0; i < made.size(); ++i) {
      const Tensor bytes = images->slice(0, static_cast<int64_t>(i), static_cast<int64_t>(i) + 1);
      made_[{made[i].source, made[i].index}].pixels = bytes.to(torch::kFloat) * (2.0 / 255) - 1;
    }
  }

  NetworkInputs InputsOf(const Job& job, const std::vector<View>& views) {
    Place(Component::kEncoder);
    Frames frames{views, {}, {}, {}, working_.height / kLatentStride, working_.width / kLatentStride};
    for (const Frame& frame : job.frames) {
      frames.given.push_back(frame.given);
      FrameImage none;
      FrameImage& image = frame.given ? FrameImageOf(frame) : none;
      if (frame.given && !image.latent.defined()) {
        ThrowIfInterrupted();
        image.latent = networks_.encode(image.pixels);
        image.embedding = networks_.embed(image.pixels);
      }
      frames.latents.push_back(image.latent);
      frames.embeddings.push_back(image.embedding);
    }
    return MakeInputs(frames, device_);
  }

  /// Latents [T, 4, h, w].
  Tensor Sample(const Job& job, int candidate, size_t index) {
    std::vector<View> views;
    std::vector<bool> given;
    for (const Frame& frame : job.frames) {
      views.push_back(ViewAt(frame));
      given.push_back(frame.given);
    }
    views = NormalizedViews(views, all_views_);
    const NetworkInputs inputs = InputsOf(job, views);
    Place(Component::kUnet);
    Denoiser denoiser;
    denoiser.schedule = &schedule_;
    denoiser.given = inputs.given;
    denoiser.weights = GuidanceWeights(views, given, options_.cfg).to(device_);
    denoiser.network = MakeNetwork(*networks_.unet, inputs, halves_);
    const std::vector<int64_t> shape = {static_cast<int64_t>(views.size()), kLatentChannels, inputs.rays.size(2),
                                        inputs.rays.size(3)};
    const auto noise = [&, draw = static_cast<uint64_t>(candidate) << 16 | index](uint64_t step) {
      return Noise({static_cast<uint64_t>(options_.seed), draw, step}, shape).to(device_);
    };
    EulerProblem problem;
    problem.sigmas = Sigmas(schedule_, options_.steps);
    problem.denoise = [&](const Tensor& x, float sigma) { return Denoise(denoiser, x, sigma); };
    problem.noise = [&](int64_t step) { return noise(static_cast<uint64_t>(step) + 1); };
    problem.after_step = [&](int64_t, const Tensor&) {
      listener_(StepDone{"propose", ++steps_done_, steps_total_, "denoising steps",
                         fmt::format("pass {}, chunk {} of {}", job.pass, index + 1, plan_.jobs.size())});
      ThrowIfInterrupted();
    };
    return SampleEuler(noise(0), problem);
  }

  /// Generated frames as [M, 3, H, W] uint8, as they are stored and condition later chunks.
  Tensor Decode(const Job& job, const Tensor& latents) const {
    Place(Component::kDecoder);
    std::vector<Tensor> images;
    for (size_t t = 0; t < job.frames.size(); ++t) {
      if (job.frames[t].given || job.frames[t].copy) continue;
      ThrowIfInterrupted();
      const Tensor latent = latents.slice(0, static_cast<int64_t>(t), static_cast<int64_t>(t) + 1);
      const Tensor image = networks_.decode(latent, tile_);
      images.push_back(((image.to(torch::kCPU) + 1) * 127.5).clamp(0, 255).to(torch::kByte));
    }
    return at::cat(images, 0);
  }

  const NetworkSet& networks_;
  const SevaOptions& options_;
  const Listener& listener_;
  ChunkStore store_;
  torch::Device device_;
  Schedule schedule_;
  Size working_;
  std::vector<View> input_views_, target_views_, all_views_;
  std::vector<ImageFit> target_fits_;
  Plan plan_;
  Halves halves_ = Halves::kBatched;
  int64_t tile_ = 0;  ///< in latent pixels
  std::vector<FrameImage> inputs_;
  std::map<FrameKey, FrameImage> made_;  ///< frames of the current candidate
  int64_t steps_done_ = 0, steps_total_ = 0;
};

}  // namespace

Generator::Generator(NetworkSet networks, SevaOptions options, Listener listener)
    : networks_(std::move(networks)), options_(std::move(options)), listener_(std::move(listener)) {
  CheckOptions(options_);
  if (!networks_.unet || !networks_.encode || !networks_.decode || !networks_.embed) {
    throw ShapeError("Generator: a network is missing");
  }
}

std::vector<std::vector<ImageF>> Generator::Generate(const ViewRequest& request) const {
  if (!request.views || request.views->empty()) {
    throw ShapeError("Generator: there are no views");
  }
  return Generation(networks_, options_, request, listener_).Run();
}

Tensor ToNetworkImage(const ImageF& image) {
  const auto copy =
      Buffer<float>::From({1, image.height, image.width, image.channels}, std::span<const float>(image.data));
  const Tensor pixels = TensorOf(copy);
  return pixels.permute({0, 3, 1, 2}).contiguous().mul(2).sub(1);
}

ImageF FromNetworkImage(const Tensor& tensor) {
  const Tensor pixels = ((tensor + 1) * 0.5).clamp(0, 1).squeeze(0).permute({1, 2, 0}).contiguous();
  ImageF image{static_cast<int>(tensor.size(3)), static_cast<int>(tensor.size(2)), 3, {}};
  image.data.assign(pixels.data_ptr<float>(), pixels.data_ptr<float>() + pixels.numel());
  return image;
}

}  // namespace oraclegs::seva
