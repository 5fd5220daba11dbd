#include "oraclegs/stages/stage_works.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

#include "oraclegs/core/files.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/text.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/image/colormap.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/networks/loader.h"
#include "oraclegs/propose/proposal_files.h"
#include "oraclegs/stages/proposer_row.h"
#include "oraclegs/stages/stage_seconds.h"
#include "oraclegs/validate/calibrated_oracle.h"
#include "oraclegs/validate/view_chunks.h"
#include "oraclegs/workspace/non_commercial.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr double kMinMeanConfidence = 0.02;  // of a proposal that is of any use, where confidence is calibrated

Image8 Gray(const ConfidenceMap& map, const Camera& camera) {
  Image8 image{camera.width, camera.height, 1, {}};
  for (const float c : map) image.data.push_back(static_cast<uint8_t>(std::lround(255 * std::clamp(c, 0.f, 1.f))));
  return image;
}

/// The proposal beside its confidence in plasma, the colors of figures.
Image8 Preview(const Validated& validated) {
  const Camera& camera = validated.proposal.camera;
  const Image8 left = ToImage8(validated.proposal.rgb);
  Image8 image{2 * camera.width, camera.height, 3, {}};
  for (int y = 0; y < camera.height; ++y) {
    const auto row = left.data.begin() + static_cast<int64_t>(y) * camera.width * 3;
    image.data.insert(image.data.end(), row, row + int64_t{3} * camera.width);
    for (int x = 0; x < camera.width; ++x) {
      const float confidence = validated.confidence[static_cast<size_t>(y) * camera.width + x];
      const auto color = MapColor(ColorMap::kPlasma, confidence);
      image.data.insert(image.data.end(), color.begin(), color.end());
    }
  }
  return image;
}

/// Paths relative to the workspace: the image and its confidence.
std::vector<std::string> FilesOf(const std::string& name) {
  return {fmt::format("proposals/{}.png", name), fmt::format("confidence/{}.png", name)};
}

/// A file is a task: packing them takes long.
void Write(const WorkspacePaths& paths, const std::vector<Validated>& all) {
  constexpr size_t kFiles = 3;  // of a view
  ParallelFor(static_cast<int64_t>(kFiles * all.size()), [&](int64_t task) {
    const auto t = static_cast<size_t>(task);
    const Validated& validated = all[t / kFiles];
    const std::string& name = validated.proposal.name;
    const std::vector<std::string> files = FilesOf(name);
    switch (t % kFiles) {
      case 0:
        return WritePng(paths.root() / files[0], ToImage8(validated.proposal.rgb));
      case 1:
        return WritePng(paths.root() / files[1], Gray(validated.confidence, validated.proposal.camera));
      default:
        return WriteFileAtomically(paths.confidence() / "preview" / (name + ".jpg"),
                                   CompressJpeg(Preview(validated), kPreviewQuality));
    }
  });
}

double Mean(std::span<const float> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// [H,W,3], or [H,W] of the first channel.
Buffer<uint8_t> ReadMap(const fs::path& path, const Camera& camera, int channels) {
  const Image8 image = ReadImage(path);
  if (image.width != camera.width || image.height != camera.height || image.channels != 3) {
    throw InputError("{}: is {} x {} with {} channels, not {} x {}; delete it and run again", path.string(),
                     image.width, image.height, image.channels, camera.width, camera.height);
  }
  if (channels == 3) {
    return Buffer<uint8_t>::From({camera.height, camera.width, 3}, std::span<const uint8_t>(image.data));
  }
  auto map = Buffer<uint8_t>::Empty({camera.height, camera.width});
  for (int64_t i = 0; i < map.count(); ++i) map[i] = image.data[static_cast<size_t>(3 * i)];
  return map;
}

void AddValidateKey(Run* run, Fingerprint* key) {
  key->Add(OptionsToJson(run->options.validate).dump()).Add(run->plan.oracle.Key());
}

void UndoValidate(Run* run, const nlohmann::json&) {
  std::error_code ignored;
  fs::remove_all(run->workspace.confidence(), ignored);
  fs::remove(run->workspace.root() / "oracle.json", ignored);
  std::vector<fs::path> images;
  for (const auto& entry : fs::directory_iterator(run->workspace.proposals(), ignored)) {
    if (entry.path().extension() == ".png") images.push_back(entry.path());
  }
  for (const auto& image : images) fs::remove(image, ignored);
}

/// The candidates that stage "propose" kept; the others are made again.
std::vector<std::vector<Proposal>> CandidatesOf(Run* run, const std::vector<Target>& targets) {
  std::vector<std::vector<Proposal>> candidates(targets.size());
  std::vector<Target> missing;
  std::vector<size_t> places;
  for (size_t t = 0; t < targets.size(); ++t) {
    if (auto kept = run->results->candidates.Take(targets[t].name)) {
      candidates[t] = std::move(*kept);
    } else {
      missing.push_back(targets[t]);
      places.push_back(t);
    }
  }
  if (missing.empty()) return candidates;
  std::vector<std::vector<Proposal>> made = ProposersOf(run).Ask(missing);
  for (size_t m = 0; m < made.size(); ++m) candidates[places[m]] = std::move(made[m]);
  return candidates;
}

OracleSetup SetupOf(const Run& run) {
  const OracleChoice& choice = run.plan.oracle;
  OracleSetup setup{choice.kind, run.options.validate};
  if (choice.weights) {
    setup.vggt = choice.weights->path;
    setup.device = DeviceOfNetworks(GetNetworks(), run.plan.device, run.listener);
    setup.precision = SettlePrecision(run.options.validate, setup.device);
    setup.free_bytes = static_cast<uint64_t>(FreeBytes(setup.device));
  }
  const auto& ready_made = run.results->folder.confidence;
  setup.unknown_errors = AsksGenerator(run) ||
                         std::any_of(ready_made.begin(), ready_made.end(), [](const auto& map) { return map.empty(); });
  setup.targets = run.results->targets.size();
  setup.seed = run.options.start.seed;
  return setup;
}

/// Classifies the proposals of one run, writes them, and counts.
class Validation {
 public:
  explicit Validation(Run* run) : run_(run), known_(*run->results) {}

  void ClassifyTargets() {
    if (known_.targets.empty()) return;
    for (const auto& [begin, end] : EvenRuns(known_.targets.size(), Together())) {
      const std::vector<Target> targets(known_.targets.begin() + static_cast<int64_t>(begin),
                                        known_.targets.begin() + static_cast<int64_t>(end));
      Take(TheOracle().Classify(CandidatesOf(run_, targets)));
    }
  }

  /// Those whose confidence was given keep it.
  void ClassifyFolder() {
    const FolderProposals& folder = known_.folder;
    std::vector<size_t> open;
    for (size_t p = 0; p < folder.proposals.size(); ++p) {
      if (folder.confidence[p].empty()) {
        open.push_back(p);
      } else {
        Take({{folder.proposals[p], folder.confidence[p]}});
      }
    }
    if (open.empty()) return;
    for (const auto& [begin, end] : EvenRuns(open.size(), Together())) {
      std::vector<std::vector<Proposal>> chunk;
      for (size_t i = begin; i < end; ++i) chunk.push_back({folder.proposals[open[i]]});
      Take(TheOracle().Classify(std::move(chunk)));
    }
  }

  nlohmann::json Record() const {
    const OracleChoice& choice = run_->plan.oracle;
    nlohmann::json record = {{"oracle", Word(choice.kind)}, {"mean_confidence", means_}, {"files", files_}};
    if (choice.weights) record["chunk"] = chunk_;
    if (chunk_ > 0 && choice.weights) NoteNetwork(*choice.weights, &record);
    return record;
  }

 private:
  /// Learns when it is first asked for.
  const CalibratedOracle& TheOracle() {
    if (!oracle_) {
      oracle_.emplace(SetupOf(*run_), ViewsOf(run_).views, ProposersOf(run_), run_->listener);
      chunk_ = oracle_->together();
    }
    return *oracle_;
  }

  size_t Together() { return TheOracle().together(); }

  void Take(const std::vector<Validated>& all) {
    Write(run_->workspace, all);
    for (const Validated& validated : all) {
      const std::string& name = validated.proposal.name;
      means_[name] = Mean(validated.confidence);
      for (std::string& file : FilesOf(name)) files_.push_back(std::move(file));
      if (oracle_ && oracle_->reports_progress()) continue;
      const size_t total = known_.targets.size() + known_.folder.proposals.size();
      run_->listener(
          StepDone{"validate", static_cast<int64_t>(means_.size()), static_cast<int64_t>(total), "views", ""});
    }
  }

  Run* run_;
  const StageResults& known_;
  std::optional<CalibratedOracle> oracle_;
  size_t chunk_ = 0;  ///< targets that were classified together; 0 = none were
  std::vector<std::string> files_;
  nlohmann::json means_ = nlohmann::json::object();
};

std::vector<Target> AllTargets(const StageResults& known) {
  std::vector<Target> targets = known.targets;
  for (const Proposal& p : known.folder.proposals) targets.push_back({p.name, p.camera});
  return targets;
}

/// Proposals that are trained on: all of them where confidence has no level, else those that are trusted anywhere.
/// Names of the others go to `rejected`.
std::vector<TrainView> ReadTrusted(const Run& run, std::vector<std::string>* rejected) {
  const std::vector<Target> targets = AllTargets(*run.results);
  std::vector<std::optional<TrainView>> read(targets.size());
  ParallelFor(static_cast<int64_t>(targets.size()), [&](int64_t task) {
    const Target& target = targets[static_cast<size_t>(task)];
    const fs::path image = run.workspace.proposals() / (target.name + ".png");
    std::error_code ignored;
    if (!fs::exists(image, ignored)) return;  // no proposer answered
    TrainView view{target.name, target.camera, {}, {}};
    view.image_bytes = ReadMap(image, target.camera, 3);
    view.weight_bytes = ReadMap(run.workspace.confidence() / (target.name + ".png"), target.camera, 1);
    read[static_cast<size_t>(task)] = std::move(view);
  });
  std::vector<TrainView> trusted;
  for (std::optional<TrainView>& view : read) {
    if (!view) continue;
    if (run.options.validate.calibrate && MeanConfidence(*view) < kMinMeanConfidence) {
      rejected->push_back(view->name);
    } else {
      trusted.push_back(std::move(*view));
    }
  }
  return trusted;
}

bool LoadValidate(Run* run) {
  std::error_code ignored;
  if (fs::exists(run->workspace.confidence() / "transforms.json", ignored)) ReadTargets(run->workspace.confidence());
  run->results->rejected.clear();
  run->results->proposals = ReadTrusted(*run, &run->results->rejected);
  return true;
}

bool HasFromFolder(const std::vector<std::string>& names, const FolderProposals& folder) {
  return std::any_of(folder.proposals.begin(), folder.proposals.end(),
                     [&](const Proposal& p) { return std::find(names.begin(), names.end(), p.name) != names.end(); });
}

void ReportConfidence(Run* run) {
  const std::vector<TrainView>& proposals = run->results->proposals;
  const std::vector<std::string>& rejected = run->results->rejected;
  const std::string previews = (run->workspace.confidence() / "preview").string();
  if (!rejected.empty()) {
    const char* then = proposals.empty() ? "; none is left, and the photos alone are trained on: another --trajectory "
                                           "or more photos may help"
                                         : "";
    const char* fix = HasFromFolder(rejected, run->results->folder)
                          ? "; for those of --proposal-folder, check scene, pose, scale and orientation"
                          : "";
    run->listener(Warning{
        fmt::format("{} of {} proposals have no confidence anywhere and are left out: {} (see {}){}{}", rejected.size(),
                    AllTargets(*run->results).size(), SomeNames(rejected), previews, fix, then)});
  }
  if (proposals.empty()) return;
  double sum = 0;
  for (const TrainView& view : proposals) sum += MeanConfidence(view);
  run->listener(Note{fmt::format("{}, mean confidence {:.2f} ({})", Counted(proposals.size(), "proposal"),
                                 sum / static_cast<double>(proposals.size()), previews)});
}

std::optional<nlohmann::json> MakeValidate(Run* run, const std::string&) {
  StageResults& known = *run->results;
  known.proposals.clear(), known.rejected.clear();
  if (known.targets.empty() && known.folder.proposals.empty()) return std::nullopt;
  ReportOracleChoice(run->options, run->plan.oracle, run->listener);
  nlohmann::json record;
  {  // The oracle's memory is not kept beside what is read back.
    Validation validation(run);
    validation.ClassifyTargets();
    validation.ClassifyFolder();
    record = validation.Record();
  }
  // Beside the maps, so that they can be shown where they are: those of a folder have their poses nowhere else.
  WriteTargets(run->workspace.confidence(), AllTargets(known), RunFromScene(run->frame).Inverse());
  known.candidates = CandidateStore(), known.proposers = nullptr;
  LoadValidate(run);
  return record;
}

std::string ValidatedText(const nlohmann::json& record) {
  const nlohmann::json means = record.value("mean_confidence", nlohmann::json::object());
  if (means.empty()) return "0 proposals";
  double sum = 0;
  for (const nlohmann::json& mean : means) sum += mean.is_number() ? mean.get<double>() : 0;
  return fmt::format("{}, mean confidence {:.2f}", Counted(means.size(), "proposal"),
                     sum / static_cast<double>(means.size()));
}

}  // namespace

StageWork ValidateStage() {
  return {.wanted = [](const Run& run) { return run.plan.has_proposals; },
          .own = AddValidateKey,
          .undo = UndoValidate,
          .make = MakeValidate,
          .load = LoadValidate,
          .report = ReportConfidence,
          .summary = ValidatedText,
          .seconds =
              [](const EstimateInput& input) {
                constexpr double kValidateOfPixel = 1.35e-6, kTeachOracleOfPixel = 5e-6, kValidate = 0.5;
                if (ProposalsOf(input) == 0) return 0.;
                const auto learned = LearnedViews(static_cast<size_t>(input.scene.views)).size();
                return kValidate +
                       (kValidateOfPixel * ProposalsOf(input) + kTeachOracleOfPixel * static_cast<double>(learned)) *
                           CoveredPixels(input);
              },
          .uses_network = [](const Run& run) { return run.plan.has_proposals && run.plan.oracle.weights.has_value(); }};
}

}  // namespace oraclegs
