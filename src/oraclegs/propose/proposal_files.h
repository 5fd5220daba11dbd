#pragma once
// Proposals and their target poses, as files that other tools open.

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "oraclegs/camera/similarity.h"
#include "oraclegs/propose/proposal.h"

namespace oraclegs {

/// Writes dir/NAME.png (8 bit RGB) for each proposal, NAME from FileNames (with "_SOURCE" where several proposals have
/// one name), and dir/transforms.json as instant-ngp, Nerfstudio and ReadTransformsScene read it: for each frame fl_x,
/// fl_y, cx, cy, w, h, file_path, and transform_matrix from camera to world with OpenGL's axes. Poses are moved by
/// `placement`. Returns the paths written, relative to dir. Throws RunError, ShapeError for an image of another size
/// than its camera.
std::vector<std::string> WriteProposals(const std::filesystem::path& dir, const std::vector<Proposal>& proposals,
                                        const Similarity& placement = {});

/// Writes the transforms.json alone, the request to a generator, whose images belong at each file_path. Poses are moved
/// by `placement`.
std::vector<std::string> WriteTargets(const std::filesystem::path& dir, const std::vector<Target>& targets,
                                      const Similarity& placement = {});

/// Reads the targets, equal bit by bit except for the rounding of rotations. Throws InputError naming the file and the
/// frame: missing, not JSON, no frames, bad intrinsics or pose, a camera model that is no pinhole, a repeated name.
std::vector<Target> ReadTargets(const std::filesystem::path& dir);

/// Proposer of images that were made for all targets at once and are stored as proposals/SOURCE/NAME.png. It cannot
/// hold a view out and has no answer then; the oracle applies its calibration by other proposers.
class StoredProposer : public Proposer {
 public:
  StoredProposer(const std::filesystem::path& proposals, std::string source)
      : source_(std::move(source)), folder_(proposals / source_) {}
  std::string name() const override { return source_; }
  /// Reads the stored image. Throws InputError for another size than the target's.
  std::optional<Proposal> Propose(const Target& target, std::optional<int> held_out) const override;

 private:
  std::string source_;
  std::filesystem::path folder_;
};

}  // namespace oraclegs
