#pragma once
// One run, what its stages found, and what a stage is.

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/depth/depth_map.h"
#include "oraclegs/depth/fusion.h"
#include "oraclegs/depth/silhouettes.h"
#include "oraclegs/propose/ensemble.h"
#include "oraclegs/propose/folder.h"
#include "oraclegs/propose/proposers.h"
#include "oraclegs/scene/frame.h"
#include "oraclegs/scene/scene.h"
#include "oraclegs/scene/split.h"
#include "oraclegs/settings/fingerprint.h"
#include "oraclegs/settings/options.h"
#include "oraclegs/settings/plan.h"
#include "oraclegs/stages/candidates.h"
#include "oraclegs/train/train_view.h"
#include "oraclegs/workspace/workspace.h"

namespace oraclegs {

/// Exposures that spread by more than this (ExposureSpread) really differ, and are learned by --exposure auto. Gloss
/// and shadow alone make 0.07 of images of one exposure (lego); a phone makes 0.10 (fox).
inline constexpr double kVariedExposure = 0.08;

/// The depth of the training views, from stereo, a network or both (--depth-prior).
struct Geometry {
  std::vector<DepthMap> maps;  ///< one for each view; empty without depth
  /// Fused; in the mean exposure of the images where exposures vary. With what a network predicts where confident
  /// pixels give few.
  std::vector<DensePoint> points;
  std::vector<Eigen::Vector3f> gains;  ///< of the images' exposures (depth/gains.h); all 1 where these do not vary

  bool HasVariedExposure() const;
};

/// How images of such exposures are fused: colors are freed of them where they vary.
FusionOptions FusionOf(const std::vector<Eigen::Vector3f>& gains);

class RunObserver;
struct EstimateInput;
struct ProposerRow;
struct Stage;

/// The training views of the split, in its order.
struct TrainingViews {
  explicit TrainingViews(std::vector<LoadedView> loaded) : views(std::move(loaded)), silhouettes(views) {}

  std::vector<LoadedView> views;
  Silhouettes silhouettes;
};

/// Results of finished stages, held for the stages of this process that need them.
struct StageResults {
  std::map<std::string, std::string> keys;     ///< keys of the stages whose results are held
  std::unique_ptr<TrainingViews> views;        ///< null = not loaded yet (ViewsOf)
  std::vector<ScenePoint> points;              ///< result of "sfm", with indices of the scene's views
  std::vector<DepthMap> stereo;                ///< of stage "poses", for "depth": made with the poses as they are now
  Geometry geometry;                           ///< result of "depth"
  std::vector<ProxyModel> proxies;             ///< result of "proxies"
  std::vector<Target> targets;                 ///< result of "propose" for the run's own proposers
  FolderProposals folder;                      ///< result of "propose": ready-made ones
  std::shared_ptr<const Proposers> proposers;  ///< null = not made yet (ProposersOf)
  CandidateStore candidates;                   ///< result of "propose"
  std::vector<TrainView> proposals;            ///< result of "validate": trained on
  std::vector<std::string> rejected;           ///< result of "validate": names of proposals that are trusted nowhere
};

/// Names of the views that train and test, where the others are left out.
struct NeededViews {
  std::vector<std::string> train, test;
};

struct Run {
  RunOptions options;
  std::string version;  ///< version of the program, for metrics.json
  Plan plan;
  Workspace workspace;
  Scene scene;  ///< has poses, but before stage "register"; refined ones after stage "poses"
  Split split;
  Listener listener;
  std::string photos;  ///< stands for images that came without poses; "" = the scene has poses of its own
  FileHashes files = {};
  std::optional<NeededViews> needed = {};        ///< kept of many photos without poses (needed_photos.h); nullopt = all
  std::optional<Scene> given = {};               ///< the scene before its poses were refined; nullopt = they were not
  SceneFrame frame = {};                         ///< that the scene was brought into, once its poses are known
  std::map<std::string, double> predicted = {};  ///< seconds of each stage; empty where nobody asked
  std::unique_ptr<StageResults> results = std::make_unique<StageResults>();
  /// --iterations that the run was begun with, of which proxy models train a share; 0 = --iterations.
  int64_t start_iterations = 0;
  const std::vector<Stage>* stages = nullptr;               ///< not null
  const std::vector<ProposerRow>* proposer_rows = nullptr;  ///< not null
  std::shared_ptr<RunObserver> observer = {};               ///< null for a run that was only opened

  /// The scene with the poses that it came with, or that were found.
  const Scene& Given() const { return given ? *given : scene; }
};

/// ViewsFingerprint of the given scene: what a stage makes of refined poses depends on stage "poses", whose key it has.
std::string ViewsKey(Run* run, const std::vector<int>& views, const ImageOptions& images);

/// The training views, loaded when they are first asked for.
const TrainingViews& ViewsOf(Run* run);

/// The training views with more pixels, for a network that reads `shorter_side` of them: where the working size has
/// fewer and the files have more, at the files' size, at most about twice what is read. Nothing where the working size
/// suffices.
std::optional<std::vector<LoadedView>> LargerViews(const Run& run, int shorter_side);

/// Work of a stage and what is known of it; stage_works.h has those of all stages.
struct StageWork {
  bool (*wanted)(const Run& run);  ///< false: this run has no such stage, and its results are empty
  /// Adds its own options, and what it reads that no stage has made.
  void (*own)(Run* run, Fingerprint* key);
  /// Removes what an earlier run of it left. `record` is that run's, null without one. May be null.
  void (*undo)(Run* run, const nlohmann::json& record) = nullptr;
  /// Does the work, writes its files, holds its result. Returns the record {"files": [...], ...}, to which key and
  /// seconds are added unless it has seconds of its own; nothing when there is no result to remember.
  std::optional<nlohmann::json> (*make)(Run* run, const std::string& key);
  /// Throws InputError when a file of the finished stage is damaged: it is made again. Null for a stage with `load`.
  void (*check)(const Run& run) = nullptr;
  /// Reads back what `make` wrote. False when that cannot be read, after a warning: it is made again. Null for a stage
  /// whose result is its files.
  bool (*load)(Run* run) = nullptr;
  /// Notes about the result. May be null.
  void (*report)(Run* run) = nullptr;
  const char* file = "";  ///< the result of a stage without `load`, which a note names
  /// Result in a few words, from a record, for the table at the end of a run.
  std::string (*summary)(const nlohmann::json& record) = nullptr;
  /// Seconds on the CPU of the reference machine (stage_seconds.h).
  double (*seconds)(const EstimateInput& input) = nullptr;
  /// True where a network or another program takes part, whose time nobody knows. May be null.
  bool (*uses_network)(const Run& run) = nullptr;
};

/// A number of a record; 0 where it has none.
inline int64_t CountIn(const nlohmann::json& record, const char* name) { return record.value(name, int64_t{0}); }

/// A row of stages.cpp.
struct Stage {
  std::string name;
  int version = 1;                 ///< raised when the same inputs give another result
  std::vector<std::string> needs;  ///< stages whose results it takes
  StageWork work;
};

/// The row of this name. Throws RunError where there is none.
const Stage& StageNamed(const std::vector<Stage>& stages, const std::string& name);

// Caching, once for all stages: key, skip, undo, run, time, record.

/// SHA-256 of name, version, own options and inputs, and of the keys of the stages it needs; "" for a stage that the
/// run does not want.
std::string StageKey(Run* run, const std::vector<Stage>& stages, const std::string& name);

/// True when the stage was finished under its present key and its files are still there.
bool IsUpToDate(Run* run, const std::vector<Stage>& stages, const std::string& name);

/// Brings a stage up to date, after those it needs: its result is then held in run->results, its files and its record
/// are in the workspace. A stage that was finished under the same key is read back, or left alone where its result is
/// its files; every other one is forgotten, undone and run. Throws what stages throw; a stage that was stopped is not
/// believed to be finished.
void RunStage(Run* run, const std::vector<Stage>& stages, const std::string& name);

/// Brings this stage alone up to date, from the files of those it needs as they are, up to date or not.
void RunStageAlone(Run* run, const std::vector<Stage>& stages, const std::string& name);

}  // namespace oraclegs
