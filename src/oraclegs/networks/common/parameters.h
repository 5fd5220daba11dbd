#pragma once
// Sources of a network's tensors. A network's structs are filled by functions that ask a ParameterSource for one tensor
// after the other by its checkpoint name and shape. One description of a network thus serves to load it from a file, to
// list its names, and to make up weights.

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "oraclegs/core/safetensors.h"
#include "oraclegs/networks/common/tensor.h"

namespace oraclegs {

class ParameterSource {
 public:
  virtual ~ParameterSource() = default;
  /// Tensor called `name`, of this shape.
  virtual Tensor Get(const std::string& name, at::IntArrayRef shape) = 0;
  /// Notes that official checkpoints hold this tensor although the network never reads it.
  virtual void Unused(const std::string& name, at::IntArrayRef shape) = 0;
};

/// A place in a checkpoint's tree of names: at / "attn" / 3 stands for the names that begin with "attn.3.".
class ParameterScope {
 public:
  explicit ParameterScope(ParameterSource& source) : source_(&source) {}

  ParameterScope operator/(const std::string& name) const {
    ParameterScope inner = *this;
    inner.prefix_ += name + ".";
    return inner;
  }
  ParameterScope operator/(int64_t index) const { return *this / std::to_string(index); }

  Tensor Get(const std::string& name, at::IntArrayRef shape) const { return source_->Get(prefix_ + name, shape); }
  void Unused(const std::string& name, at::IntArrayRef shape) const { source_->Unused(prefix_ + name, shape); }

 private:
  ParameterSource* source_;
  std::string prefix_;
};

struct CheckpointOptions {
  std::string model = "this network";  ///< its name in messages
  std::string prefix = {};             ///< in front of the network's names in the file; other names are ignored
  std::vector<std::string> ignored =
      {};  ///< beginnings of names (behind the prefix) that may be in the file and are not read
  /// Parts of names as older files spell them, each with its spelling in this network; the first that is found is
  /// replaced.
  std::vector<std::pair<std::string, std::string>> older_names = {};
  torch::Device device = torch::kCPU;
  /// Names that begin with `cast_prefix` become `cast_type`; all others become float32.
  torch::ScalarType cast_type = torch::kFloat;
  std::string cast_prefix = {};
};

/// Reads safetensors files of F32, F16, BF16 or F64. Float32 on the CPU is not copied: the tensors are the mapped file.
/// They must not be written to, and only what a forward pass reads takes memory.
class FileParameters : public ParameterSource {
 public:
  /// Opens the files, whose names together make up one checkpoint. Throws InputError as SafetensorsFile does.
  FileParameters(const std::vector<std::filesystem::path>& paths, CheckpointOptions options);

  /// Notes a tensor that is missing or does not fit, and returns one without memory (device meta) in its place. A
  /// matrix may be stored as the convolution of a single pixel, [out, in, 1, 1].
  Tensor Get(const std::string& name, at::IntArrayRef shape) override;
  void Unused(const std::string& name, at::IntArrayRef shape) override;
  /// Throws one InputError that lists tensors that are missing, stored twice, not floating-point or of another shape.
  /// It also lists tensors that the network does not have, which alone are no error. At most twenty of each kind are
  /// named. Call it when the network is filled, before it is used.
  void Finish() const;

 private:
  struct Place {
    std::shared_ptr<const SafetensorsFile> file;
    const TensorEntry* entry;
  };
  bool Ignores(const std::string& name) const;
  torch::ScalarType TypeOf(const std::string& name) const;

  CheckpointOptions options_;
  std::string files_;
  std::map<std::string, Place> places_;
  std::set<std::string> known_;
  std::vector<std::string> missing_, twice_, wrong_type_, wrong_shape_;
};

/// Shapes of the tensors in some files; they tell which size of a network the files hold.
class StoredShapes {
 public:
  /// Throws InputError as SafetensorsFile does.
  explicit StoredShapes(const std::vector<std::filesystem::path>& paths);

  bool Has(const std::string& name) const;
  /// Shape of a tensor; nullopt unless a file holds it with so many dimensions, all of them positive.
  std::optional<std::vector<int64_t>> Find(const std::string& name, size_t dimensions) const;
  /// File names, for messages.
  const std::string& files() const { return names_; }

 private:
  std::vector<SafetensorsFile> files_;
  std::string names_;
};

/// Notes names and shapes; the tensors have no memory (device meta).
class ListedParameters : public ParameterSource {
 public:
  Tensor Get(const std::string& name, at::IntArrayRef shape) override;
  void Unused(const std::string& name, at::IntArrayRef shape) override;
  const std::map<std::string, std::vector<int64_t>>& shapes() const { return shapes_; }

 private:
  std::map<std::string, std::vector<int64_t>> shapes_;
};

/// Makes up weights that keep the size of activations: uniform with variance 1/inputs; scales of norms near 1, other
/// vectors near 0. For measurements and tests of full-size networks. Results do not depend on the number of threads.
class RandomParameters : public ParameterSource {
 public:
  explicit RandomParameters(uint64_t seed) : seed_(seed) {}
  Tensor Get(const std::string& name, at::IntArrayRef shape) override;
  void Unused(const std::string&, at::IntArrayRef) override {}

 private:
  uint64_t seed_, tensors_ = 0;
};

}  // namespace oraclegs
