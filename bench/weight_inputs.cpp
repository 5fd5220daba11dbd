#include <map>

#include "bench/parser_inputs.h"
#include "oraclegs/core/safetensors.h"
#include "oraclegs/core/safetensors_layout.h"
#include "oraclegs/weights/checkpoint/state_dict.h"
#include "oraclegs/weights/checkpoint/torch_file.h"
#include "weights/checkpoint/torch_bytes.h"

namespace oraclegs {
namespace {

namespace torch = torch_bytes;

std::string Safetensors(const std::string& header, const std::string& data) {
  return torch::Bytes(header.size(), 8) + header + data;
}

void ReadTorch(const std::string& file) {
  PickleHeap heap;
  heap.file = "f";
  FindStateDict(ReadTorchFile(file, &heap), "", heap);
}

std::string TorchZip(const std::string& pickle) { return torch::Zip({{"a/data.pkl", torch::Pickle(pickle)}}); }

}  // namespace

std::vector<ParserInput> WeightInputs() {
  const auto safetensors = [](const std::string& file) { SafetensorsFile::Parse(file, "f"); };
  return {
      {"safetensors", "many tensors",
       [](size_t bytes) {
         size_t count = 0;
         const std::string list = Repeated(bytes, [&](size_t i) {
           ++count;
           return (i == 0 ? "" : ",") + Numbered("\"t", i, "\":{\"dtype\":\"U8\",\"shape\":[1],\"data_offsets\":[") +
                  std::to_string(i) + "," + std::to_string(i + 1) + "]}";
         });
         return Safetensors("{" + list + "}", std::string(count, 'x'));
       },
       safetensors},
      {"safetensors", "one large tensor",
       [](size_t bytes) {
         const std::string n = std::to_string(bytes);
         return Safetensors(R"({"t":{"dtype":"U8","shape":[)" + n + R"(],"data_offsets":[0,)" + n + "]}}",
                            std::string(bytes, 'x'));
       },
       safetensors},
      {"safetensors", "one long shape",
       [](size_t bytes) {
         return Safetensors(R"({"t":{"dtype":"U8","shape":[)" + Repeated(bytes, [](size_t) { return "1,"; }) +
                                R"(1],"data_offsets":[0,1]}})",
                            "x");
       },
       safetensors},
      {"shard index", "many names",
       [](size_t bytes) {
         return "{\"weight_map\":{" +
                Repeated(bytes, [](size_t i) { return Numbered("\"t", i, "\":\"x-1.safetensors\","); }) +
                "\"z\":\"x-1.safetensors\"}}";
       },
       [](const std::string&) { ReadShardIndex(BenchFolder() / "x.safetensors.index.json"); },
       "x.safetensors.index.json"},
      {"pickle", "many tensors",
       [](size_t bytes) {
         std::vector<std::pair<std::string, std::string>> items;
         for (size_t i = 0; i < bytes / 180; ++i) {
           items.emplace_back(Numbered("t", i, ".weight"), torch::Tensor(torch::Storage("0", 1), {{1}, {1}}));
         }
         return torch::Zip({{"a/data.pkl", torch::Pickle(torch::Dict(items))}, {"a/data/0", "1234"}});
       },
       ReadTorch},
      {"pickle", "many storages",
       [](size_t bytes) {
         std::vector<std::pair<std::string, std::string>> items, none;
         std::map<std::string, std::string> files;
         for (size_t i = 0; i < bytes / 300; ++i) {
           const std::string key = std::to_string(i);
           items.emplace_back("t" + key, torch::Tensor(torch::Storage(key, 1), {{1}, {1}}));
           files["a/data/" + key] = "1234";
         }
         files["a/data.pkl"] = torch::Pickle(torch::Dict(items));
         return torch::Zip({files.begin(), files.end()});
       },
       ReadTorch},
      {"pickle", "one name again",
       [](size_t bytes) {
         std::vector<std::pair<std::string, std::string>> items;
         for (size_t i = 0; i < bytes / 180; ++i) {
           items.emplace_back("t.weight", torch::Tensor(torch::Storage("0", 1), {{1}, {1}}));
         }
         return torch::Zip({{"a/data.pkl", torch::Pickle(torch::Dict(items))}, {"a/data/0", "1234"}});
       },
       ReadTorch},
      {"pickle", "nested tuples", [](size_t bytes) { return TorchZip("N" + std::string(bytes, '\x85')); }, ReadTorch},
      {"pickle", "copies of one text",
       [](size_t bytes) { return TorchZip("](" + torch::Text("a") + std::string(bytes, '2') + "e"); }, ReadTorch},
      {"pickle", "marks", [](size_t bytes) { return TorchZip(std::string(bytes, '(') + std::string(bytes, 't')); },
       ReadTorch},
      {"pickle", "appends to one list",
       [](size_t bytes) { return TorchZip("]" + Repeated(bytes, [](size_t) { return "Na"; })); }, ReadTorch},
      {"pickle", "many names of Python's",
       [](size_t bytes) {
         return TorchZip("](" + Repeated(bytes, [](size_t i) { return torch::Global("m", Numbered("n", i, "")); }) +
                         "e");
       },
       ReadTorch},
      {"pickle", "dicts in dicts",
       [](size_t bytes) {
         const size_t n = bytes / 9;
         return TorchZip(Repeated(8 * n, [](size_t) { return "}(" + torch::Text("a"); }) + "}" + std::string(n, 'u'));
       },
       ReadTorch},
      {"pickle", "before PyTorch 1.6",
       [](size_t bytes) {
         std::vector<std::pair<std::string, std::string>> items;
         std::map<std::string, std::string> storages;
         for (size_t i = 0; i < bytes / 250; ++i) {
           const std::string key = std::to_string(i);
           items.emplace_back("t" + key, torch::Vector(key, 1));
           storages[key] = "1234";
         }
         return torch::LegacyFile(torch::Dict(items), storages);
       },
       ReadTorch},
  };
}

}  // namespace oraclegs
