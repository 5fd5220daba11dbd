#include "oraclegs/pipeline/settings/oracle_choice.h"

namespace oraclegs {
namespace {

constexpr int64_t kUsualChunk = 8;
constexpr double kGiB = 1024.0 * 1024 * 1024;

double GiB(double bytes) { return bytes / kGiB; }

}  // namespace

OracleChoice ChooseOracle(const RunOptions& options) {
  const std::string& word = options.validate.oracle;
  if (word == "consistency" || word == "uniform") return {word, std::nullopt};
  if (word != "auto") return {word, RequireVggtWeights(options.weights.vggt_weights, "--oracle " + word)};
  auto weights = FindVggtWeights(options.weights.vggt_weights);
  if (!weights) return {"consistency", std::nullopt};
  return {"vggt+consistency", std::move(weights)};
}

void TellOracle(const RunOptions& options, const OracleChoice& choice, const Listener& listener) {
  if (options.validate.oracle != "auto") return;
  if (choice.weights) {
    listener(
        Note{fmt::format("oracle: {} with the photographs ({})", choice.weights->name, choice.weights->path.string())});
    return;
  }
  listener(Note{"oracle: the photographs alone, without VGGT; `oraclegs models fetch vggt` brings its weights"});
}

size_t ChooseChunk(const std::function<int64_t(int64_t)>& bytes, int64_t asked, uint64_t available,
                   const Listener& listener) {
  const auto fits = [&](int64_t chunk) { return available == 0 || static_cast<uint64_t>(bytes(chunk)) <= available; };
  const double free = GiB(static_cast<double>(available));
  if (asked > 0) {
    if (!fits(asked)) {
      listener(Warning{fmt::format("--oracle-chunk {}: a pass needs about {:.1f} GiB, {:.1f} GiB are free", asked,
                                   GiB(static_cast<double>(bytes(asked))), free)});
    }
    return static_cast<size_t>(asked);
  }
  int64_t chunk = kUsualChunk;
  while (chunk > 1 && !fits(chunk)) --chunk;
  if (!fits(chunk)) {
    throw RunError(
        "VGGT needs about {:.1f} GiB of memory for one proposal beside a photograph, {:.1f} GiB are free; free some, "
        "or "
        "use --oracle consistency",
        GiB(static_cast<double>(bytes(1))), free);
  }
  if (chunk < kUsualChunk) {
    listener(Warning{fmt::format(
        "VGGT looks at {} proposals at a time, not {}, for {:.1f} GiB of memory are free; --oracle-chunk {} gives the "
        "same confidence again",
        chunk, kUsualChunk, free, chunk)});
  }
  return static_cast<size_t>(chunk);
}

}  // namespace oraclegs
