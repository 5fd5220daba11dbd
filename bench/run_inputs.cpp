#include <algorithm>

#include "bench/parser_inputs.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/output/live/curves.h"
#include "oraclegs/train/checkpoint.h"
#include "oraclegs/workspace/stage_records.h"

namespace oraclegs {

std::vector<ParserInput> RunInputs() {
  return {
      {"json", "many keys",
       [](size_t bytes) {
         return "{" + Repeated(bytes, [](size_t i) { return Numbered("\"k", i, "\":0,"); }) + "\"z\":0}";
       },
       [](const std::string& file) { ParseUniqueJson(file, "f", "f"); }},
      {"json", "many arrays", [](size_t bytes) { return "[" + Repeated(bytes, [](size_t) { return "[],"; }) + "0]"; },
       [](const std::string& file) { ParseUniqueJson(file, "f", "f"); }},
      {"checkpoint", "Gaussians",
       [](size_t bytes) {
         const auto n = static_cast<int64_t>(std::max<size_t>(bytes / 708, 1));
         Checkpoint checkpoint;
         checkpoint.gaussians = Gaussians::Zeros(n);
         checkpoint.adam = Adam(n);
         checkpoint.options = {{"seed", 1}};
         WriteCheckpoint(BenchFolder() / "made.safetensors", checkpoint);
         return ReadFile(BenchFolder() / "made.safetensors");
       },
       [](const std::string&) { ReadCheckpoint(BenchFolder() / "a.safetensors"); }, "a.safetensors"},
      {"checkpoint", "many options",
       [](size_t bytes) {
         Checkpoint checkpoint;
         checkpoint.gaussians = Gaussians::Zeros(1);
         checkpoint.adam = Adam(1);
         for (size_t i = 0; i < bytes / 16; ++i) checkpoint.options[Numbered("k", 1000000 + i, "")] = 0;
         WriteCheckpoint(BenchFolder() / "made.safetensors", checkpoint);
         return ReadFile(BenchFolder() / "made.safetensors");
       },
       [](const std::string&) { ReadCheckpoint(BenchFolder() / "a.safetensors"); }, "a.safetensors"},
      {"curves", "rows",
       [](size_t bytes) {
         return Repeated(std::min<size_t>(bytes, 4 << 20),
                         [](size_t i) { return Numbered("", i + 1, ",1.5,2,0.1,0.1,0.9,,,,,100,20\n"); });
       },
       [](const std::string&) { ReadCurves(BenchFolder() / "train.csv"); }, "train.csv"},
      {"stage records", "many",
       [](size_t bytes) {
         return "{" + Repeated(bytes, [](size_t i) { return Numbered("\"s", i, "\":{\"seconds\":1},"); }) + "\"z\":{}}";
       },
       [](const std::string&) { ReadStageRecords(BenchFolder()); }, "stages.json"},
  };
}

}  // namespace oraclegs
