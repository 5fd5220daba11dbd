#include "oraclegs/train/checkpoint.h"

#include <zlib.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <map>
#include <string>
#include <string_view>
#include <type_traits>

#include "oraclegs/core/atomic_file.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/safetensors.h"
#include "oraclegs/core/unique_json.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFormat = "oraclegs-checkpoint";
constexpr int64_t kFormatVersion = 3;
// Before the names of a state's arrays, and before those of a model: "state.NAME", "model.NAME.means".
constexpr const char *kState = "state.", *kModel = "model.";
// The checksum is that of the whole file with these digits at zero, so that it covers every byte.
constexpr std::string_view kChecksumMark = "crc32=", kNoChecksum = "00000000";

std::string Checksum(std::string_view bytes) {
  uLong crc = crc32_z(0, nullptr, 0);
  crc = crc32_z(crc, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
  return fmt::format("{:08x}", static_cast<uint32_t>(crc));
}

/// Position of the checksum's digits in the file's header, npos when there are none.
size_t FindChecksum(std::string_view bytes) {
  uint64_t header = 0;
  if (bytes.size() < sizeof(header)) return std::string_view::npos;
  std::memcpy(&header, bytes.data(), sizeof(header));
  const std::string_view text = bytes.substr(sizeof(header));
  const size_t found = text.substr(0, std::min<uint64_t>(header, text.size())).find(kChecksumMark);
  if (found == std::string_view::npos) return found;
  const size_t digits = sizeof(header) + found + kChecksumMark.size();
  return digits + kNoChecksum.size() <= bytes.size() ? digits : std::string_view::npos;
}

template <class T>
TensorEntry Entry(const char* dtype, std::vector<int64_t> shape, const T* data, int64_t count) {
  return {dtype, std::move(shape), {reinterpret_cast<const char*>(data), count * sizeof(T)}};
}

void AddParameters(const std::string& prefix, const Gaussians& gaussians, std::map<std::string, TensorEntry>* tensors) {
  gaussians.Check("WriteCheckpoint");
  gaussians.ForEach([&](const char* name, const Buffer<float>& t) {
    tensors->emplace(prefix + name, Entry("F32", {t.shape().begin(), t.shape().end()}, t.data(), t.count()));
  });
}

/// Adds the moments. Compact moments have sh as BF16 and one F32 for each Gaussian.
void AddMoments(const std::string& prefix, Adam adam, std::map<std::string, TensorEntry>* tensors) {
  adam.Check("WriteCheckpoint", adam.size());
  adam.ForEachMoment([&](const char* moment, const char* name, const auto& t) {
    const char* dtype = sizeof(t[0]) == sizeof(float) ? "F32" : "BF16";
    tensors->emplace(fmt::format("{}adam.{}.{}", prefix, moment, name),
                     Entry(dtype, {t.shape().begin(), t.shape().end()}, t.data(), t.count()));
  });
}

/// Adds the exposure maps. Without trained ones it adds nothing.
void AddExposures(const std::string& prefix, const ExposureState& state, std::map<std::string, TensorEntry>* tensors) {
  if (state.maps.empty()) return;
  const auto add = [&](const char* name, const std::vector<ExposureMap>& maps) {
    const auto views = static_cast<int64_t>(maps.size());
    tensors->emplace(prefix + name, Entry("F32", {views, 3, 4}, maps.data(), views));
  };
  add("exposure.maps", state.maps);
  add("exposure.adam.m", state.m);
  add("exposure.adam.v", state.v);
  const auto views = static_cast<int64_t>(state.steps.size());
  tensors->emplace(prefix + "exposure.adam.steps", Entry("I64", {views}, state.steps.data(), views));
}

/// Contents of a file before it is written.
struct Contents {
  std::map<std::string, TensorEntry> tensors;
  std::map<std::string, std::string> metadata;

  /// Adds one model with its state, under names that begin with `prefix`.
  void Add(const std::string& prefix, const Checkpoint& checkpoint) {
    AddParameters(prefix, checkpoint.gaussians, &tensors);
    AddMoments(prefix, checkpoint.adam, &tensors);
    const auto add_stack = [&](const char* name, const std::vector<int64_t>& stack) {
      const auto size = static_cast<int64_t>(stack.size());
      tensors.emplace(prefix + name, Entry("I64", {size}, stack.data(), size));
    };
    add_stack("sampler.photos", checkpoint.sampler.photos);
    add_stack("sampler.proposals", checkpoint.sampler.proposals);
    AddExposures(prefix, checkpoint.exposures, &tensors);
    for (const auto& [name, t] : checkpoint.state.arrays) {
      tensors.emplace(prefix + kState + name, Entry("F32", {t.shape().begin(), t.shape().end()}, t.data(), t.count()));
    }
    for (const auto& [name, model] : checkpoint.state.models) Add(prefix + kModel + name + ".", *model);
    const auto set = [&](const char* key, std::string value) { metadata[prefix + key] = std::move(value); };
    set("iteration", std::to_string(checkpoint.iteration));
    set("adam.step", std::to_string(checkpoint.adam.step));
    set("sampler.counter", std::to_string(checkpoint.sampler.counter));
    set("sampler.num_photos", std::to_string(checkpoint.sampler.num_photos));
    set("sampler.num_proposals", std::to_string(checkpoint.sampler.num_proposals));
    set("seconds", fmt::format("{}", checkpoint.seconds));
    set("loss", fmt::format("{}", checkpoint.loss));
    set("options", DumpOptions(checkpoint.options));
  }
};

/// A model of an opened checkpoint, whose names begin with `prefix`; every access that fails names the file.
struct Reader {
  const fs::path& path;
  const SafetensorsFile& file;
  std::string prefix;

  const std::string& Text(const std::string& key) const {
    const auto found = file.metadata().find(prefix + key);
    if (found == file.metadata().end()) throw InputError("{}: the metadata has no '{}'", path.string(), prefix + key);
    return found->second;
  }

  bool Has(const std::string& name) const { return file.Has(prefix + name); }

  template <class T>
  T Number(const std::string& key) const {
    const std::string& text = Text(key);
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) {
      throw InputError("{}: {} is '{}', must be a {}number", path.string(), prefix + key, text,
                       std::is_integral_v<T> ? "whole " : "");
    }
    return value;
  }

  nlohmann::json Json(const std::string& key) const {
    nlohmann::json value = ParseJsonOrDiscard(Text(key));
    if (value.is_discarded()) throw InputError("{}: {} is not valid JSON", path.string(), prefix + key);
    return value;
  }

  const TensorEntry& Typed(const std::string& name, const char* dtype) const {
    const TensorEntry& entry = file.Get(prefix + name);
    if (entry.dtype != dtype) {
      throw InputError("{}: {} is of type {}, expected {}", path.string(), prefix + name, entry.dtype, dtype);
    }
    return entry;
  }

  std::vector<int64_t> Integers(const std::string& name) const {
    const TensorEntry& entry = Typed(name, "I64");
    if (entry.shape.size() != 1) throw InputError("{}: {} must have one axis", path.string(), prefix + name);
    std::vector<int64_t> values(entry.bytes.size() / sizeof(int64_t));
    if (!values.empty()) std::memcpy(values.data(), entry.bytes.data(), entry.bytes.size());
    return values;
  }

  std::vector<ExposureMap> Maps(const std::string& name, int64_t views) const {
    const TensorEntry& entry = Typed(name, "F32");
    if (entry.shape != std::vector<int64_t>{views, 3, 4}) {
      throw InputError("{}: {} has shape [{}], expected [{}, 3, 4]", path.string(), prefix + name,
                       fmt::join(entry.shape, ", "), views);
    }
    std::vector<ExposureMap> maps(views);
    if (!entry.bytes.empty()) std::memcpy(maps.data(), entry.bytes.data(), entry.bytes.size());
    return maps;
  }

  /// Exposure maps; empty where the run did not train them.
  ExposureState Exposures() const {
    if (!Has("exposure.maps")) return {};
    std::vector<int64_t> steps = Integers("exposure.adam.steps");
    const auto views = static_cast<int64_t>(steps.size());
    return {Maps("exposure.maps", views), Maps("exposure.adam.m", views), Maps("exposure.adam.v", views),
            std::move(steps)};
  }

  /// A tensor of this shape; T is float or, for BF16, uint16_t.
  template <class T>
  Buffer<T> Array(const std::string& name, const Shape& shape) const {
    const TensorEntry& entry = Typed(name, std::is_same_v<T, float> ? "F32" : "BF16");
    if (!std::equal(entry.shape.begin(), entry.shape.end(), shape.begin(), shape.end())) {
      throw InputError("{}: {} has shape [{}], expected {}", path.string(), prefix + name, fmt::join(entry.shape, ", "),
                       shape.Text());
    }
    Buffer<T> array = Buffer<T>::Empty(shape);
    if (!entry.bytes.empty()) std::memcpy(array.data(), entry.bytes.data(), entry.bytes.size());
    return array;
  }

  /// The five tensors of the model, each of `n` Gaussians.
  Gaussians Parameters(int64_t n) const {
    Gaussians result = Gaussians::Empty(0);  // for the shapes
    result.ForEach([&](const char* name, Buffer<float>& t) { t = Array<float>(name, t.shape().WithRows(n)); });
    return result;
  }

  Adam Moments(int64_t n) const {
    const auto is_half = [&](const char* name) { return Has(name) && file.Get(prefix + name).dtype == "BF16"; };
    const ShMoments kind = !is_half("adam.m.sh")  ? ShMoments::kFull
                           : is_half("adam.v.sh") ? ShMoments::kHalf
                                                  : ShMoments::kCompact;
    Adam adam(0, kind);  // for the shapes
    adam.ForEachMoment([&]<class T>(const char* moment, const char* name, Buffer<T>& t) {
      t = Array<T>(fmt::format("adam.{}.{}", moment, name), t.shape().WithRows(n));
    });
    adam.step = Number<int64_t>("adam.step");
    return adam;
  }

  /// State that densifier and parts carried. A model is known by its positions.
  NamedState State() const {
    constexpr std::string_view kMeans = ".means";
    NamedState state;
    for (const auto& [full, entry] : file.tensors()) {
      if (!full.starts_with(prefix)) continue;
      const std::string_view name = std::string_view(full).substr(prefix.size());
      if (name.starts_with(kState)) {
        const std::string own(name.substr(std::string_view(kState).size()));
        if (entry.shape.size() > Shape::kMaxDims) throw InputError("{}: {} has too many axes", path.string(), full);
        state.arrays[own] = Array<float>(kState + own, Shape(std::span<const int64_t>(entry.shape)));
      } else if (name.starts_with(kModel) && name.ends_with(kMeans)) {
        const size_t begin = std::string_view(kModel).size();
        const std::string own(name.substr(begin, name.size() - kMeans.size() - begin));
        if (own.find('.') != std::string::npos) continue;  // a model's own model
        state.models[own] = std::make_shared<const Checkpoint>(Reader{path, file, prefix + kModel + own + "."}.Model());
      }
    }
    return state;
  }

  /// The model with its state.
  Checkpoint Model() const {
    const TensorEntry& means = Typed("means", "F32");
    const int64_t n = means.shape.empty() ? 0 : means.shape[0];
    Checkpoint checkpoint;
    checkpoint.iteration = Number<int64_t>("iteration");
    checkpoint.gaussians = Parameters(n);
    checkpoint.adam = Moments(n);
    checkpoint.sampler = {Integers("sampler.photos"), Integers("sampler.proposals"),
                          Number<uint64_t>("sampler.counter"), Number<int64_t>("sampler.num_photos"),
                          Number<int64_t>("sampler.num_proposals")};
    checkpoint.exposures = Exposures();
    checkpoint.state = State();
    checkpoint.seconds = Number<double>("seconds");
    checkpoint.loss = Number<double>("loss");
    checkpoint.options = Json("options");
    if (checkpoint.iteration < 0 || checkpoint.adam.step < 0) {
      throw InputError("{}: iteration {} and step {} must not be negative", path.string(), checkpoint.iteration,
                       checkpoint.adam.step);
    }
    return checkpoint;
  }
};

/// Throws InputError unless the file's checksum is that of its bytes.
void VerifyChecksum(const fs::path& path, std::string* bytes) {
  const size_t at = FindChecksum(*bytes);
  if (at == std::string::npos) {
    throw InputError("{}: is not a checkpoint of oraclegs; delete it to start from the one before it", path.string());
  }
  const std::string stored = bytes->substr(at, kNoChecksum.size());
  bytes->replace(at, kNoChecksum.size(), kNoChecksum);
  if (Checksum(*bytes) != stored) {
    throw InputError("{}: is damaged (checksum mismatch); delete it to continue from the one before it", path.string());
  }
}

}  // namespace

Buffer<float> NamedState::Array(const std::string& name, const Shape& shape) const {
  const auto found = arrays.find(name);
  if (found == arrays.end() || found->second.shape() != shape) {
    throw InputError("the checkpoint holds no state '{}' of this training; start anew with --overwrite", name);
  }
  return found->second.Clone();
}

const Checkpoint& NamedState::Model(const std::string& name) const {
  const auto found = models.find(name);
  if (found == models.end()) {
    throw InputError("the checkpoint holds no model '{}' of this training; start anew with --overwrite", name);
  }
  return *found->second;
}

std::string DumpOptions(const nlohmann::json& options) {
  return options.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

void CheckSameOptions(const fs::path& dir, const nlohmann::json& saved, const nlohmann::json& now) {
  if (DumpOptions(saved) == DumpOptions(now)) return;
  std::string difference = "other options";
  for (const auto& [name, value] : saved.items()) {
    if (!now.is_object() || !now.contains(name) || DumpOptions(now[name]) == DumpOptions(value)) continue;
    difference = fmt::format("{} {}, not {}", name, DumpOptions(value), DumpOptions(now[name]));
    break;
  }
  throw InputError("{}: the checkpoint was made with {}; continue with those options or choose another folder",
                   dir.string(), difference);
}

void WriteCheckpoint(const fs::path& path, const Checkpoint& checkpoint) {
  Contents contents;
  contents.metadata = {{"format", kFormat},
                       {"format_version", std::to_string(kFormatVersion)},
                       {"checksum", std::string(kChecksumMark) + std::string(kNoChecksum)}};
  contents.Add("", checkpoint);
  std::string bytes = SerializeSafetensors(contents.tensors, contents.metadata);
  const size_t at = FindChecksum(bytes);
  if (at == std::string::npos) throw std::logic_error("WriteCheckpoint: the header lost the checksum");
  bytes.replace(at, kNoChecksum.size(), Checksum(bytes));
  WriteFileAtomically(path, bytes);
}

Checkpoint ReadCheckpoint(const fs::path& path) {
  std::string bytes = ReadFile(path);
  VerifyChecksum(path, &bytes);
  const SafetensorsFile file = SafetensorsFile::Parse(std::move(bytes), path.string());
  const Reader reader{path, file, ""};
  if (reader.Text("format") != kFormat) throw InputError("{}: is not a checkpoint of oraclegs", path.string());
  const auto version = reader.Number<int64_t>("format_version");
  if (version != kFormatVersion) {
    throw InputError("{}: has format version {}, this program reads {}; continue with the program that wrote it",
                     path.string(), version, kFormatVersion);
  }
  return reader.Model();
}

}  // namespace oraclegs
