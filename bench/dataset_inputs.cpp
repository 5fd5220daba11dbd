#include "bench/parser_inputs.h"
#include "datasets/dataset_files.h"
#include "oraclegs/core/files.h"
#include "oraclegs/datasets/bundler.h"
#include "oraclegs/datasets/metashape.h"
#include "oraclegs/datasets/npy.h"
#include "oraclegs/datasets/reality_scan.h"
#include "oraclegs/datasets/record3d.h"
#include "weights/checkpoint/torch_bytes.h"

namespace oraclegs {
namespace {

constexpr char kBundleCamera[] = "500 0.1 0.01\n1 0 0\n0 1 0\n0 0 1\n0 0 5\n";

std::string Xml(const std::string& cameras, const std::string& components = "") {
  return "<document><chunk><sensors><sensor id=\"0\"><resolution width=\"4\" height=\"3\"/><calibration><f>5</f>"
         "</calibration></sensor></sensors><components>" +
         components + "</components><cameras>" + cameras + "</cameras></chunk></document>";
}

std::string XmlCamera(size_t i) {
  return Numbered("<camera sensor_id=\"0\" label=\"a", i,
                  "\"><transform>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</transform></camera>");
}

}  // namespace

std::vector<ParserInput> DatasetInputs() {
  const auto bundler = [](const std::string&) {
    ReplaceFile(BenchFolder() / "list.txt", "a.jpg\n");
    ReadBundlerScene(BenchFolder(), {}, Silent());
  };
  const auto metashape = [](const std::string&) { ReadMetashapeScene(BenchFolder(), {}, Silent()); };
  const auto reality_scan = [](const std::string&) { ReadRealityScanScene(BenchFolder(), {}, Silent()); };
  const auto record3d = [](const std::string&) {
    RequireWritableFolder(BenchFolder() / "rgb");
    ReplaceFile(BenchFolder() / "rgb/0.jpg", "");
    ReadRecord3dScene(BenchFolder(), {}, Silent());
  };
  const auto npy = [](const std::string& file) { ParseNpy(file, "f"); };
  return {
      {"npy", "rows",
       [](size_t bytes) { return NpyOf(fmt::format("({}, 17)", bytes / 136), std::string(bytes / 136 * 136, '\1')); },
       npy},
      {"npy", "Fortran order",
       [](size_t bytes) {
         return NpyOf(fmt::format("({}, 17)", bytes / 136), std::string(bytes / 136 * 136, '\1'), "<f8", "True");
       },
       npy},
      {"npy", "a long header",
       [](size_t bytes) {
         std::string file = NpyOf("(2,)", std::string(16, '\1'));
         file[6] = 2;
         const std::string header = Repeated(bytes, [](size_t) { return "'descr' 'shape' "; });
         file.replace(8, 2, torch_bytes::Bytes(header.size(), 4));
         return file.insert(12, header);
       },
       npy},
      {"bundler", "cameras",
       [](size_t bytes) {
         const size_t n = bytes / (sizeof kBundleCamera - 1);
         return fmt::format("# Bundle file v0.3\n{} 0\n", n) + Repeated(bytes, [](size_t) { return kBundleCamera; });
       },
       bundler, "bundle.out"},
      {"bundler", "points",
       [](size_t bytes) {
         constexpr std::string_view kPoint = "1 2 3\n4 5 6\n1 0 7 1.5 2.5\n";
         return fmt::format("# Bundle file v0.3\n1 {}\n{}", bytes / kPoint.size(), kBundleCamera) +
                Repeated(bytes, [&](size_t) { return std::string(kPoint); });
       },
       bundler, "bundle.out"},
      {"metashape", "cameras", [](size_t bytes) { return Xml(Repeated(bytes, XmlCamera)); }, metashape, "cameras.xml"},
      {"metashape", "cameras of one name",
       [](size_t bytes) { return Xml(Repeated(bytes, [](size_t) { return XmlCamera(0); })); }, metashape,
       "cameras.xml"},
      {"metashape", "components",
       [](size_t bytes) {
         return Xml("", Repeated(bytes, [](size_t i) { return Numbered("<component id=\"", i, "\"/>"); }));
       },
       metashape, "cameras.xml"},
      {"metashape", "deep nesting", [](size_t bytes) { return Xml(Repeated(bytes, [](size_t) { return "<group>"; })); },
       metashape, "cameras.xml"},
      {"record3d", "poses",
       [](size_t bytes) {
         return R"({"K":[5,0,0,0,5,0,2,1.5,1],"w":4,"h":3,"poses":[)" +
                Repeated(bytes, [](size_t) { return std::string("[0,0,0,1,1,2,3],"); }) + "[0,0,0,1,1,2,3]]}";
       },
       record3d, "metadata.json"},
      {"reality scan", "lines",
       [](size_t bytes) {
         return "#name,x,y,alt,heading,pitch,roll,f\n" +
                Repeated(bytes, [](size_t i) { return Numbered("a", i, ".jpg,1,2,3,4,5,6,50\n"); });
       },
       reality_scan, "cameras.csv"},
      {"reality scan", "columns",
       [](size_t bytes) {
         return "#name,x,y,alt,heading,pitch,roll,f" + Repeated(bytes, [](size_t i) { return Numbered(",c", i, ""); }) +
                "\n";
       },
       reality_scan, "cameras.csv"},
  };
}

}  // namespace oraclegs
