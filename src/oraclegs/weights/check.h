#pragma once
// Whether a file holds the weights it should.

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/core/safetensors_layout.h"
#include "oraclegs/weights/parameter_list.h"
#include "oraclegs/weights/registry.h"

namespace oraclegs {

struct WeightsFaults {
  std::vector<std::string> missing;      ///< names
  std::vector<std::string> extra;        ///< names
  std::vector<std::string> wrong_shape;  ///< "NAME is [3], expected [4]"
  std::vector<std::string> wrong_type;   ///< "NAME is I64"

  /// True when all that the network reads is there and fits.
  bool only_extra() const { return missing.empty() && wrong_shape.empty() && wrong_type.empty(); }
};

/// All names may begin with "module.", as some published files have it. Types: F32, F16, BF16, F64.
WeightsFaults CompareParameters(const std::map<std::string, TensorLayout>& held, const ParameterList& expected);

/// "; 23 missing: a, b, ... and 3 more; 1 of another shape: ...": of each kind the first twenty. Empty without faults.
std::string FaultsText(const WeightsFaults& faults);

/// Checks names, shapes and types in the file against the list of its network, and reads no number; returns how many
/// tensors of it there are. Tensors that are no part of it alone are a warning. Throws InputError that names the file
/// and lists the faults, of each kind the first twenty, or what SafetensorsFile::Open says.
size_t CheckWeights(const WeightsInfo& model, const std::filesystem::path& weights, const Listener& listener);

/// Compares the SHA-256 of the file with the one under which its network is published. Returns false where there is
/// nothing to compare: the published files are converted, the SHA-256 is not known, or the file is the index of parts.
/// Reports StepDone{"check"}. Throws InputError when it is another file.
bool CheckPublished(const WeightsInfo& model, const std::filesystem::path& weights, const Listener& listener);

/// Throws InputError for a file that is published as another one of `all` than `model`: versions of a network have the
/// same names and shapes. Reads a file of about the published length alone, and reports as CheckPublished does.
void RefuseAnotherNetwork(const WeightsInfo& model, const std::vector<WeightsInfo>& all,
                          const std::filesystem::path& weights, const Listener& listener);

}  // namespace oraclegs
