#pragma once
// Works of the stages, in the order of run/stages.cpp; that of "evaluate" is in evaluate_stage.h.

#include "oraclegs/gaussians/selection.h"
#include "oraclegs/stages/stage.h"

namespace oraclegs {

/// Stage "masks": has the command of --masks mask the photos, into masks/. The run's scene then has these masks, and no
/// others.
StageWork MasksStage();

/// Stage "register": poses for images without any, by colmap or by VGGT (--poses), into sfm/. The run's scene then has
/// poses, and the views that were registered.
StageWork RegisterStage();

/// Network of --poses. In a workspace whose poses stand already it has the weights that found them, also when those are
/// no longer on this machine. nullopt = colmap. Throws InputError as RequireVggtWeights where no poses stand.
std::optional<VggtWeights> PoseNetworkOf(const RunOptions& options, const Workspace& workspace);

/// Stage "sfm": sparse points of the training views, with indices of run->scene. A COLMAP model's points count when the
/// training views saw them; otherwise, or when they are too few, points are triangulated from the training views
/// (cached in sfm/). Not wanted where no other stage would use them.
StageWork SfmStage();

/// Stage "poses": holds poses against dense stereo, and corrects those of the training views where they are off; the
/// run's scene then has the corrected ones, and other views follow. Writes sfm/refined.json. Says how far each view was
/// off, and warns where no small correction helps.
StageWork PosesStage();

/// Stage "depth": multi-view stereo over the training views, in the order of the split, and what Depth Anything V2
/// predicts of each (--depth-prior). Writes depth/ and sfm/dense.ply. Reports what share of the pixels is confident,
/// how often the network was right, or what brings its weights where it is missed; warns of views of which next to
/// nothing is known. Throws InputError for weights that are damaged.
StageWork DepthStage();

/// For a command that wants nothing but depth: the stage is wanted, whatever the options need. Throws UsageError for
/// --depth-prior none.
void RequireDepth(Run* run);

/// Views of the scene that neither train nor test.
std::vector<int> SpareViews(const Run& run);

/// True where what is proposed depends on a run's seed; else runs of several seeds can share it. A generator's own seed
/// is an option of its own.
bool AreProposalsSeeded(const RunOptions& options);

/// Stage "propose": chooses target poses (never a test pose), has a generative network or the command of --generator
/// paint where they are asked for, and writes what each proposer predicts to proposals/PROPOSER/NAME.png, with the
/// poses in proposals/transforms.json; reads a folder of proposals. The candidates stay in memory for stage "validate",
/// as far as they fit. Without enough confident depth, or without a usable pose, nothing is proposed, with a warning.
StageWork ProposeStage();

/// Stage "validate": has the oracle classify each candidate, makes one image of the candidates of each target, and maps
/// its confidence so that it predicts the similarity held-out views had. Writes what is trained on: proposals/NAME.png,
/// confidence/NAME.png (8 bit, 255 = trust), confidence/preview/NAME.png (yellow = trust, purple = do not, beside the
/// proposal). Proposals that are trusted nowhere are left out, with a warning that names them.
StageWork ValidateStage();

/// Stage "train": writes point_cloud.ply, continuing from the newest checkpoint to the same bits. The last
/// checkpoint stays: the same run with more --iterations goes on from it, over the new number's schedule. When what it
/// is trained on has changed it starts anew with a warning, and the old point_cloud.ply and metrics.json are removed.
/// On an interrupt a checkpoint is saved and Interrupted thrown.
StageWork TrainStage();

/// Writes Gaussians in the run's coordinates as point_cloud.ply, without their far dust and with the comments of the
/// run. Returns the number written.
int64_t WriteSplat(const Run& run, const Gaussians& gaussians, const GaussianMarks& marks);

}  // namespace oraclegs
