#pragma once
// Checkpoints: a run that was stopped continues to the same bits. One safetensors file with a checksum, readable with
// any tool.

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "oraclegs/train/adam.h"
#include "oraclegs/train/exposure.h"
#include "oraclegs/train/view_sampler.h"

namespace oraclegs {

struct Checkpoint;

/// State of a densifier or of a method's parts between iterations. Each has names of its own, of letters, digits and
/// "_".
struct NamedState {
  std::map<std::string, Buffer<float>> arrays;                      ///< on the host
  std::map<std::string, std::shared_ptr<const Checkpoint>> models;  ///< trainings beside this one

  /// A copy of the array. Throws InputError that says how to go on where there is none of this shape.
  Buffer<float> Array(const std::string& name, const Shape& shape) const;
  /// Throws InputError that says how to go on where there is none.
  const Checkpoint& Model(const std::string& name) const;
};

struct Checkpoint {
  int64_t iteration = 0;  ///< finished iterations
  Gaussians gaussians;
  Adam adam{0};
  ViewSampler::State sampler;
  ExposureState exposures;  ///< empty, and absent from the file, where they are not trained
  NamedState state;         ///< what the densifier and the parts carry; empty with MCMC alone
  double seconds = 0;       ///< training time so far
  double loss = 0;          ///< smoothed loss shown to the user
  nlohmann::json options;   ///< options the run was started with; resuming compares them
};

/// Text of the options in the file; two runs with the same text may continue each other. Bytes of a path that are not
/// UTF-8 are replaced.
std::string DumpOptions(const nlohmann::json& options);

/// Throws InputError that names the first option that differs between a checkpoint in `dir` and this run.
void CheckSameOptions(const std::filesystem::path& dir, const nlohmann::json& saved, const nlohmann::json& now);

/// Writes a temporary file, flushes and renames it. Throws RunError.
void WriteCheckpoint(const std::filesystem::path& path, const Checkpoint& checkpoint);

/// Reads a checkpoint. Throws InputError naming the file: wrong format version, checksum, shapes or keys.
Checkpoint ReadCheckpoint(const std::filesystem::path& path);

}  // namespace oraclegs
