#include "oraclegs/weights/check.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>
#include <system_error>

#include "oraclegs/core/error.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/safetensors.h"
#include "oraclegs/core/sha256.h"
#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

constexpr size_t kMaxListed = 20;
constexpr std::string_view kWrapper = "module.";

std::string Shape(const std::vector<int64_t>& shape) { return fmt::format("[{}]", fmt::join(shape, ", ")); }

/// "; 23 missing: a, b, ... and 3 more", or nothing.
std::string Listed(const char* what, const std::vector<std::string>& names) {
  if (names.empty()) return "";
  const size_t shown = std::min(names.size(), kMaxListed);
  const std::vector<std::string> first(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(shown));
  const std::string more = shown < names.size() ? fmt::format(" and {} more", names.size() - shown) : "";
  return fmt::format("; {} {}: {}{}", names.size(), what, fmt::join(first, ", "), more);
}

/// SHA-256 of a file's bytes. Reports StepDone{"check"}.
std::string ChecksumOf(const std::filesystem::path& path, const Listener& listener) {
  constexpr uint64_t kMega = 1'000'000;
  std::ifstream file(path, std::ios::binary);
  std::error_code error;
  const uint64_t bytes = std::filesystem::file_size(path, error);
  std::string piece(kMega, '\0');
  Sha256 sum;
  for (uint64_t done = 0; file; listener(StepDone{"check", static_cast<int64_t>(done / kMega),
                                                  static_cast<int64_t>((bytes + kMega - 1) / kMega), "MB", ""})) {
    ThrowIfInterrupted();
    file.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    const auto read = static_cast<size_t>(file.gcount());
    sum.Add(std::string_view(piece).substr(0, read));
    done += read;
  }
  return sum.Hex();
}

}  // namespace

WeightsFaults CompareParameters(const std::map<std::string, TensorLayout>& held, const ParameterList& expected) {
  static const std::set<std::string> kTypes = {"F32", "F16", "BF16", "F64"};
  const bool wrapped = !held.empty() && std::all_of(held.begin(), held.end(),
                                                    [](const auto& item) { return item.first.starts_with(kWrapper); });
  WeightsFaults faults;
  std::set<std::string> seen;
  for (const auto& [stored, entry] : held) {
    const std::string name = wrapped ? stored.substr(kWrapper.size()) : stored;
    seen.insert(name);
    const auto it = expected.tensors.find(name);
    if (it == expected.tensors.end()) {
      if (!expected.Ignores(name)) faults.extra.push_back(Printable(name));
      continue;
    }
    if (entry.shape != it->second.shape) {
      faults.wrong_shape.push_back(
          fmt::format("{} is {}, expected {}", name, Shape(entry.shape), Shape(it->second.shape)));
    } else if (!kTypes.count(entry.dtype)) {
      faults.wrong_type.push_back(fmt::format("{} is {}", name, entry.dtype));
    }
  }
  for (const auto& [name, tensor] : expected.tensors) {
    if (!tensor.optional && !seen.count(name)) faults.missing.push_back(name);
  }
  return faults;
}

std::string FaultsText(const WeightsFaults& faults) {
  return Listed("missing", faults.missing) + Listed("that are no part of it", faults.extra) +
         Listed("of another shape", faults.wrong_shape) + Listed("of a type that cannot be read", faults.wrong_type);
}

size_t CheckWeights(const WeightsInfo& model, const std::filesystem::path& weights, const Listener& listener) {
  const SafetensorsFile file = SafetensorsFile::Open(weights);
  std::map<std::string, TensorLayout> held;
  for (const auto& [name, entry] : file.tensors()) held[name] = {entry.dtype, entry.shape};
  const WeightsFaults faults = CompareParameters(held, ParametersOf(model.parameters));
  if (!faults.only_extra()) {
    throw InputError("{}: does not hold {}{}; `oraclegs models fetch {}` gets its official weights", weights.string(),
                     model.name, FaultsText(faults), model.name);
  }
  if (!faults.extra.empty()) {
    listener(Warning{fmt::format("{}: holds {} tensors that are no part of {} and are not read: {}", weights.string(),
                                 faults.extra.size(), model.name, SomeNames(faults.extra))});
  }
  return held.size() - faults.extra.size();
}

bool CheckPublished(const WeightsInfo& model, const std::filesystem::path& weights, const Listener& listener) {
  if (model.convert || model.files.size() != 1 || model.files[0].sha256.empty() || weights.extension() == ".json") {
    return false;
  }
  const std::string sum = ChecksumOf(weights, listener);
  if (sum == model.files[0].sha256) return true;
  throw InputError(
      "{}: is not the file that the authors of {} publish: its SHA-256 is {}, expected {}; remove it and run `oraclegs "
      "models fetch {}`, or use it if you trust whom it is from",
      weights.string(), model.name, sum, model.files[0].sha256, model.name);
}

void RefuseAnotherNetwork(const WeightsInfo& model, const std::vector<WeightsInfo>& all,
                          const std::filesystem::path& weights, const Listener& listener) {
  constexpr double kAboutAsLong = 0.01;
  std::error_code error;
  const auto bytes = static_cast<double>(std::filesystem::file_size(weights, error));
  const auto published = static_cast<double>(model.download_bytes);
  if (error || std::abs(bytes - published) > kAboutAsLong * published) return;
  const std::string sum = ChecksumOf(weights, listener);
  for (const WeightsInfo& other : all) {
    if (other.name == model.name || other.files.size() != 1 || other.files[0].sha256 != sum) continue;
    throw InputError("{}: holds {}, not {}; store it as {}/model.safetensors and run `oraclegs models fetch {}`",
                     weights.string(), other.name, model.name, other.name, model.name);
  }
}

}  // namespace oraclegs
