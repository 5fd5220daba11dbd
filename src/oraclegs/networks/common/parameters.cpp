#include "oraclegs/networks/common/parameters.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>

#include "oraclegs/core/parallel.h"
#include "oraclegs/core/rng.h"
#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

constexpr size_t kListed = 20;

std::string ShapeText(at::IntArrayRef shape) { return fmt::format("[{}]", fmt::join(shape, ", ")); }

Tensor WithoutMemory(at::IntArrayRef shape) {
  return torch::empty(shape, torch::TensorOptions(torch::kMeta).dtype(torch::kFloat));
}

/// "; WHAT 23: a, b, ... and 3 more"; empty without names.
std::string Listed(const char* what, const std::vector<std::string>& names) {
  if (names.empty()) return "";
  const size_t shown = std::min(names.size(), kListed);
  const std::vector<std::string> first(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(shown));
  std::string more;
  if (shown < names.size()) more = fmt::format(" and {} more", names.size() - shown);
  return fmt::format("; {} {}: {}{}", what, names.size(), fmt::join(first, ", "), more);
}

/// Current name of a tensor; a file may spell it in an older way.
std::string CurrentName(std::string name, const std::vector<std::pair<std::string, std::string>>& older_names) {
  for (const auto& [older, current] : older_names) {
    const size_t place = name.find(older);
    if (place != std::string::npos) return name.replace(place, older.size(), current);
  }
  return name;
}

bool Fits(at::IntArrayRef stored, at::IntArrayRef wanted) {
  const bool matrix_of_a_pixel = wanted.size() == 2 && stored.size() == 4 && stored[2] == 1 && stored[3] == 1;
  return (matrix_of_a_pixel ? stored.slice(0, 2) : stored) == wanted;
}

std::optional<torch::ScalarType> FloatType(const std::string& dtype) {
  if (dtype == "F32") return torch::kFloat;
  if (dtype == "F16") return torch::kHalf;
  if (dtype == "BF16") return torch::kBFloat16;
  if (dtype == "F64") return torch::kDouble;
  return std::nullopt;
}

}  // namespace

FileParameters::FileParameters(const std::vector<std::filesystem::path>& paths, CheckpointOptions options)
    : options_(std::move(options)) {
  for (const auto& path : paths) {
    files_ += (files_.empty() ? "" : " + ") + path.string();
    const auto file = std::make_shared<const SafetensorsFile>(SafetensorsFile::Open(path));
    for (const auto& [stored, entry] : file->tensors()) {
      if (!stored.starts_with(options_.prefix)) continue;
      const std::string name = CurrentName(stored.substr(options_.prefix.size()), options_.older_names);
      if (!places_.emplace(name, Place{file, &entry}).second && !Ignores(name)) twice_.push_back(Printable(name));
    }
  }
}

bool FileParameters::Ignores(const std::string& name) const {
  return std::any_of(options_.ignored.begin(), options_.ignored.end(),
                     [&](const std::string& beginning) { return name.starts_with(beginning); });
}

torch::ScalarType FileParameters::TypeOf(const std::string& name) const {
  return name.starts_with(options_.cast_prefix) ? options_.cast_type : torch::kFloat;
}

Tensor FileParameters::Get(const std::string& name, at::IntArrayRef shape) {
  known_.insert(name);
  const auto it = places_.find(name);
  if (it == places_.end()) {
    missing_.push_back(name);
    return WithoutMemory(shape);
  }
  const Place& place = it->second;
  const TensorEntry& entry = *place.entry;
  const auto type = FloatType(entry.dtype);
  if (!type) {
    wrong_type_.push_back(fmt::format("{} is {}", name, Printable(entry.dtype)));
    return WithoutMemory(shape);
  }
  if (!Fits(entry.shape, shape)) {
    wrong_shape_.push_back(fmt::format("{} is {}, expected {}", name, ShapeText(entry.shape), ShapeText(shape)));
    return WithoutMemory(shape);
  }
  // The deleter keeps the mapping alive as long as any tensor of it. Nobody writes to it.
  Tensor stored = torch::from_blob(
      std::bit_cast<void*>(entry.bytes.data()), shape, [keep = place.file](void*) {}, *type);
  const bool aligned = reinterpret_cast<uintptr_t>(entry.bytes.data()) % stored.element_size() == 0;
  if (!aligned) stored = torch::empty(shape, *type);
  if (!aligned) std::copy(entry.bytes.begin(), entry.bytes.end(), static_cast<char*>(stored.data_ptr()));
  return stored.to(options_.device, TypeOf(name));
}

void FileParameters::Unused(const std::string& name, at::IntArrayRef) { known_.insert(name); }

void FileParameters::Finish() const {
  std::vector<std::string> extra;
  for (const auto& [name, place] : places_) {
    if (!known_.count(name) && !Ignores(name)) extra.push_back(Printable(name));
  }
  const std::string faults = Listed("missing", missing_) + Listed("twice there", twice_) +
                             Listed("no floating-point tensor", wrong_type_) + Listed("of another shape", wrong_shape_);
  if (faults.empty()) return;
  throw InputError("{}: does not hold {}{}{}; get its official weights again, or name the model that the file holds",
                   files_, options_.model, faults, Listed("not part of it", extra));
}

StoredShapes::StoredShapes(const std::vector<std::filesystem::path>& paths) {
  for (const auto& path : paths) {
    names_ += (names_.empty() ? "" : " + ") + path.string();
    files_.push_back(SafetensorsFile::Open(path));
  }
}

bool StoredShapes::Has(const std::string& name) const {
  return std::any_of(files_.begin(), files_.end(), [&](const SafetensorsFile& file) { return file.Has(name); });
}

std::optional<std::vector<int64_t>> StoredShapes::Find(const std::string& name, size_t dimensions) const {
  for (const SafetensorsFile& file : files_) {
    if (!file.Has(name)) continue;
    const std::vector<int64_t>& shape = file.Get(name).shape;
    const bool positive = std::all_of(shape.begin(), shape.end(), [](int64_t side) { return side > 0; });
    if (positive && shape.size() == dimensions) return shape;
  }
  return std::nullopt;
}

Tensor ListedParameters::Get(const std::string& name, at::IntArrayRef shape) {
  shapes_[name] = shape.vec();
  return WithoutMemory(shape);
}

void ListedParameters::Unused(const std::string& name, at::IntArrayRef shape) { shapes_[name] = shape.vec(); }

Tensor RandomParameters::Get(const std::string& name, at::IntArrayRef shape) {
  const Tensor out = torch::empty(shape, torch::kFloat);
  const bool matrix = shape.size() >= 2;
  const bool scale = !matrix && (name.ends_with("weight") || name.ends_with("gamma"));
  const int64_t n = out.numel();
  const float inputs = matrix ? static_cast<float>(n / std::max<int64_t>(shape[0], 1)) : 0;
  const float amplitude = matrix ? std::sqrt(3.f / std::max(inputs, 1.f)) : 0.1f, center = scale ? 1.f : 0.f;
  float* values = out.data_ptr<float>();
  const uint64_t stream = tensors_++;
  ParallelBlocks(n, 1 << 16, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; i += 4) {
      const Philox r = Philox::Draw(seed_, stream, static_cast<uint64_t>(i));
      for (int64_t j = i; j < std::min(i + 4, end); ++j) {
        values[j] = center + amplitude * (2 * OpenUniform(r.x[j - i]) - 1);
      }
    }
  });
  return out;
}

}  // namespace oraclegs
