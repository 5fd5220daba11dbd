// Makes the seeds of binary formats by the program's own writers: fuzz_seeds CORPUS_FOLDER. Those of texts are written
// by hand.

#include <sqlite3.h>

#include "datasets/dataset_files.h"
#include "formats/splats.h"
#include "fuzz/fuzz.h"
#include "image/jpeg_files.h"
#include "image/photo_files.h"
#include "oraclegs/core/safetensors.h"
#include "oraclegs/formats/codecs.h"
#include "oraclegs/formats/gzip.h"
#include "oraclegs/formats/zip_archive.h"
#include "oraclegs/gaussians/ply.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/mesh/triangle_mesh.h"
#include "oraclegs/settings/options.h"
#include "oraclegs/train/checkpoint.h"
#include "weights/checkpoint/torch_bytes.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using fuzz::Big;
using fuzz::Little;

/// Writes corpus/TARGET/seed-NAME.
class Corpus {
 public:
  explicit Corpus(fs::path root) : root_(std::move(root)) {}

  void Add(const std::string& target, const std::string& name, const std::string& bytes) const {
    WriteFileAtomically(root_ / target / ("seed-" + name), bytes);
  }
  /// Bytes that `write` writes to a path that ends in `name`.
  template <class Write>
  std::string Written(const std::string& name, const Write& write) const {
    write(folder_.path() / name);
    return ReadFile(folder_.path() / name);
  }

 private:
  fs::path root_;
  fuzz::Folder folder_;
};

std::string Double(double value) { return {reinterpret_cast<const char*>(&value), sizeof value}; }

void AddColmap(const Corpus& corpus) {
  std::string cameras = Little(2, 8) + Little(1, 4) + Little(1, 4) + Little(640, 8) + Little(480, 8);
  for (const double x : {500., 500., 320., 240.}) cameras += Double(x);
  cameras += Little(2, 4) + Little(4, 4) + Little(64, 8) + Little(48, 8);
  for (const double x : {50., 50., 32., 24., .1, .01, 0., 0.}) cameras += Double(x);
  corpus.Add("colmap_binary", "cameras", cameras);
  std::string images = Little(2, 8);
  for (int i = 1; i <= 2; ++i) {
    images += Little(static_cast<uint64_t>(i), 4);
    for (const double x : {1., 0., 0., 0., 0.5, double(i), 2.}) images += Double(x);
    images +=
        Little(1, 4) + "a/" + std::to_string(i) + ".jpg" + '\0' + Little(1, 8) + Double(3) + Double(4) + Little(7, 8);
  }
  corpus.Add("colmap_binary", "images", images);
  std::string points = Little(1, 8) + Little(7, 8) + Double(1) + Double(2) + Double(3) + "rgb" + Double(0.5);
  corpus.Add("colmap_binary", "points",
             points + Little(2, 8) + Little(1, 4) + Little(0, 4) + Little(2, 4) + Little(0, 4));
}

/// Two views with a distorted lens, by the writers that the tests of the readers have.
void AddDatasets(const Corpus& corpus) {
  std::vector<SceneView> views(2);
  for (size_t i = 0; i < views.size(); ++i) {
    views[i].name = std::to_string(i + 1) + ".png";
    views[i].intrinsics = {CameraModel::kPinhole, 4, 3, {5, 5, 2, 1.5}};
    views[i].cam_from_world =
        Eigen::Isometry3d(Eigen::AngleAxisd(0.3 * static_cast<double>(i), Eigen::Vector3d::UnitY()));
    views[i].cam_from_world->translation() = Eigen::Vector3d(static_cast<double>(i), 0, 2);
  }
  corpus.Add("llff", "two", LlffFile(views));
  const std::string identity = NpyOf("(4, 4)", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});
  std::string arrays;
  for (const auto& [name, array] : ReadZip(NeusFile(views), 10, "seed")) {
    if (name.starts_with("world")) arrays += array + "\n====\n";
  }
  corpus.Add("neus", "arrays", arrays + identity + "\n====\n" + identity);
  corpus.Add("neus", "archive", NeusFile(views));
  const std::vector<ScenePoint> points = {{{1, 2, 3}, {1, 2, 3}, {0, 1}}};
  corpus.Add("bundler", "two", BundleFile(views, points, -0.1, 0.01) + "====\n" + BundleList(views));
  corpus.Add("metashape", "two", MetashapeXml(views, "<b1>1</b1><b2>1</b2><k1>0.1</k1><k3>0.1</k3><p1>0.1</p1>"));
  corpus.Add("polycam", "one",
             R"({"fx":5,"fy":5,"cx":2,"cy":1.5,"width":4,"height":3,"t_00":1,"t_01":0,"t_02":0,"t_03":1,"t_10":0,)"
             R"("t_11":1,"t_12":0,"t_13":2,"t_20":0,"t_21":0,"t_22":1,"t_23":3})");
  corpus.Add("record3d", "two",
             R"({"K":[5,0,0,0,5,0,2,1.5,1],"w":4,"h":3,"fps":60,"poses":[[0,0,0,1,0,0,0],[0,0.1,0,0.995,1,2,3]]})");
  corpus.Add("reality_scan", "two", RealityScanCsv(views, "0.1,0.2,0.3,0,0.01,0.02"));
}

void AddSplats(const Corpus& corpus) {
  const Gaussians g = PlausibleGaussians(2);
  const GaussianMarks marks{{0.25f, 1.f}};
  for (const int degree : {0, 1, 3}) {
    const std::string name = "degree" + std::to_string(degree);
    corpus.Add("ply", name, corpus.Written("a.ply", [&](const fs::path& path) {
      WriteGaussianPly(path, g, degree, {"a unit is 2 m"}, marks);
    }));
    corpus.Add("ply", "compressed-" + name, EncodeCompressedPly(g, degree, {"comment"}));
    corpus.Add("spz", name + "-4", EncodeSpz(g, degree, SpzVersion::k4));
    corpus.Add("usd", name, EncodeUsda(g, degree, 0.5));
    corpus.Add("usd", "archive-" + name, EncodeUsdz(g, degree));
    for (const SpzVersion version : {SpzVersion::k2, SpzVersion::k3}) {
      const std::string file = EncodeSpz(g, degree, version), of = name + (version == SpzVersion::k2 ? "-2" : "-3");
      corpus.Add("spz", of, file);
      corpus.Add("spz", "unpacked-" + of, Gunzip(file, "f").Next(1 << 20));
    }
    corpus.Add("sog", name, EncodeSog(g, degree, marks.support));
    const auto two_parts = [](const std::string& glb, bool unpack) {
      const auto length = LoadLittle<uint32_t>(glb, 12);
      const std::string bin = glb.substr(28 + length);
      return glb.substr(20, length) + "====\n" + (unpack ? Gunzip(bin, "f").Next(1 << 20) : bin);
    };
    const std::string glb = EncodeGltf(g, degree, marks.support), packed = EncodeGltfSpz(g, degree);
    corpus.Add("gltf", name, glb);
    corpus.Add("gltf", "parts-" + name, two_parts(glb, false));
    corpus.Add("gltf", "spz-" + name, packed);
    corpus.Add("gltf", "spz-parts-" + name, two_parts(packed, true));
  }
  corpus.Add("splat", "two", EncodeSplat(g));
  corpus.Add("splat", "spz", ".spz\n" + EncodeSpz(g, 0));
  corpus.Add("splat", "named", ".splat\n" + EncodeSplat(g));
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.colors.assign(3, {1, 2, 3});
  mesh.triangles = {{0, 1, 2}};
  SetNormals(&mesh);
  corpus.Add("ply", "mesh", corpus.Written("mesh.ply", [&](const fs::path& path) {
    WriteMesh(path, mesh, {0, 1, 0});
  }));
}

std::string PngBytes(const Corpus& corpus, const Image8& image) {
  return corpus.Written("a.png", [&](const fs::path& path) { WritePng(path, image); });
}

void AddImages(const Corpus& corpus) {
  for (const int channels : {1, 3, 4}) {
    corpus.Add("png", std::to_string(channels), PngBytes(corpus, SmoothImage(5, 4, channels)));
  }
  corpus.Add("png", "16", corpus.Written("b.png", [&](const fs::path& path) {
    WritePng16(path, 4, 3, std::vector<uint16_t>(12, 40000));
  }));
  const auto header = [](int bits, int color, int interlaced) {
    return Big(4, 4) + Big(3, 4) + Big(static_cast<uint64_t>(bits), 1) + Big(static_cast<uint64_t>(color), 1) +
           std::string(2, '\0') + Big(static_cast<uint64_t>(interlaced), 1);
  };
  for (const auto& [bits, color] : {std::pair(1, 0), {2, 3}, {4, 3}, {8, 4}, {16, 2}, {16, 6}}) {
    for (const int interlaced : {0, 1}) {
      corpus.Add("png", fmt::format("rows-{}-{}-{}", bits, color, interlaced),
                 header(bits, color, interlaced) + std::string(120, '\0'));
    }
  }
  const Image8 rgb = SmoothImage(16, 8, 3), rgba = SmoothImage(16, 8, 4);
  const std::string jpeg = EncodeJpeg(rgb);
  corpus.Add("jpeg", "rgb", jpeg);
  corpus.Add("jpeg", "turned", WithOrientation(jpeg, 6));
  corpus.Add("jpeg", "exif", WithExif(jpeg, PhoneExif()));
  corpus.Add("jpeg", "progressive", EncodeJpeg(rgb, {TJPF_RGB, TJSAMP_420, TJFLAG_PROGRESSIVE}));
  corpus.Add("jpeg", "gray", EncodeJpeg(rgb, {TJPF_RGB, TJSAMP_GRAY, 0}));
  corpus.Add("jpeg", "cmyk", EncodeJpeg(rgba, {TJPF_CMYK, TJSAMP_444, 0}));
  const std::string heic = EncodeHeif(rgb, PhoneExif(6)), avif = EncodeHeif(rgba, "", heif_compression_AV1);
  corpus.Add("heif", "heic", heic);
  corpus.Add("heif", "avif", avif);
  const auto tiff = [&](const Image8& image, const TiffLayout& layout) {
    return corpus.Written("a.tif", [&](const fs::path& path) { EncodeTiff(path, image, layout); });
  };
  for (const uint16_t compression :
       {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE, COMPRESSION_PACKBITS}) {
    corpus.Add("tiff", std::to_string(compression), tiff(rgb, {8, 1, compression}));
  }
  corpus.Add("tiff", "16", tiff(rgba, {16, 3, COMPRESSION_NONE}));
  corpus.Add("webp", "rgb", EncodeWebp(rgb));
  corpus.Add("webp", "exif", EncodeWebp(rgba, PhoneExif(3)));
  corpus.Add("exif", "block", PhoneExif());
  corpus.Add("exif", "jpeg", WithExif(jpeg, PhoneExif(8)).substr(0, 700));
  corpus.Add("exif", "webp", EncodeWebp(SmoothImage(2, 2, 3), PhoneExif()));
  corpus.Add("exif", "heic", heic);
  corpus.Add("exif", "gpano",
             "GPano:ProjectionType=\"equirectangular\" GPano:FullPanoWidthPixels=\"8\" "
             "GPano:CroppedAreaImageWidthPixels=\"8\" <GPano:CroppedAreaTopPixels>0</GPano:CroppedAreaTopPixels>");
  corpus.Add("exif", "png",
             std::string("\x89PNG\r\n\x1a\n", 8) + Big(PhoneExif().size(), 4) + "eXIf" + PhoneExif() + "crc!");
  corpus.Add("photo", "jpeg", jpeg);
  corpus.Add("photo", "png", PngBytes(corpus, SmoothImage(5, 4, 3)));
  corpus.Add("photo", "heic", heic);
  corpus.Add("photo", "webp", EncodeWebp(rgb));
  corpus.Add("photo", "tiff", tiff(rgb, {}));
  corpus.Add("archives", "gzip", Gzip("hello hello hello"));
  corpus.Add("archives", "zip", WriteZip({{"meta.json", "{}"}, {"a.webp", "x"}}));
  corpus.Add("archives", "photos", WriteZip({{"a/1.jpg", "x"}, {"../2.png", "y"}, {"masks/1.png", ""}, {"3.cr2", ""}}));
}

void AddWeights(const Corpus& corpus) {
  const std::string numbers(64, '\7');
  std::map<std::string, TensorEntry> tensors;
  for (const char* dtype : {"F32", "F64", "I32", "I64", "U8", "F16", "BF16"}) {
    const bool wide = std::string_view(dtype).ends_with("64"), byte = std::string_view(dtype) == "U8";
    const size_t size = wide ? 8 : byte ? 1 : std::string_view(dtype).ends_with("32") ? 4 : 2;
    tensors[dtype] = {dtype, {2, 1}, std::string_view(numbers).substr(0, 2 * size)};
  }
  const std::string file = SerializeSafetensors(tensors, {{"format", "pt"}});
  const auto two_parts = [](const std::string& bytes) {
    const auto length = LoadLittle<uint64_t>(bytes, 0);
    return bytes.substr(8, length) + "====\n" + bytes.substr(8 + length);
  };
  corpus.Add("safetensors", "all", file);
  corpus.Add("safetensors", "parts", two_parts(file));

  Checkpoint c;
  c.iteration = 1234;
  c.gaussians = PlausibleGaussians(1, 1), c.adam.m = PlausibleGaussians(1, 2), c.adam.v = PlausibleGaussians(1, 3);
  c.adam.step = 1233;
  c.sampler = {{5, 0, 3}, {2}, 0xfedcba9876543210, 6, 4};
  c.options = {{"iterations", 7000}};
  for (const bool exposure : {false, true}) {
    if (exposure) c.exposures = {{ExposureMap{}}, {ExposureMap{}}, {ExposureMap{}}, {3}};
    const std::string bytes = corpus.Written("c", [&](const fs::path& path) { WriteCheckpoint(path, c); });
    corpus.Add("train_checkpoint", exposure ? "exposure" : "plain", bytes);
    corpus.Add("train_checkpoint", exposure ? "parts-exposure" : "parts", two_parts(bytes));
  }
  c.exposures = {};
  c.adam = Adam(1, ShMoments::kCompact);
  for (int k = 0; k < kShFloats; ++k) c.adam.sh_m[k] = static_cast<uint16_t>(0x3f00 + k);
  c.adam.sh_v[0] = 0.5f;
  const std::string compact = corpus.Written("c", [&](const fs::path& path) { WriteCheckpoint(path, c); });
  corpus.Add("train_checkpoint", "compact", compact);
  corpus.Add("train_checkpoint", "parts-compact", two_parts(compact));

  using namespace torch_bytes;  // NOLINT: files and pieces of pickles
  const std::string root = Dict({{"a", Vector("0", 3)}, {"b", Vector("1", 2)}});
  const std::map<std::string, std::string> storages = {{"0", Floats({1, 2, 3})}, {"1", Floats({4, 5})}};
  corpus.Add("checkpoint", "zip", ZipFile(root, storages));
  corpus.Add("checkpoint", "legacy", LegacyFile(root, storages));
  corpus.Add("checkpoint", "pickle", Pickle(root));
  corpus.Add("checkpoint", "wide", Zip({{"x/data.pkl", Pickle(root)}, {"x/data/0", "a"}}, true));
}

/// Adds pickles of published checkpoints: objects besides tensors in a dict.
void AddPickles(const Corpus& corpus) {
  using namespace torch_bytes;  // NOLINT: pieces of pickles
  const auto add = [&](const std::string& name, const std::string& root) {
    corpus.Add("checkpoint", name, Pickle(root));
  };
  const std::string tensor = Vector("0", 3), ordered = Global("collections", "OrderedDict");
  add("ordered", Call(ordered, {List({Tuple({Text("module.a"), tensor}), Tuple({Text("module.b"), tensor})})}));
  add("parameter",
      Dict({{"model", Dict({{"a", Call(Global("torch._utils", "_rebuild_parameter"), {tensor, "\x88", "}"})}})}}));
  const std::string rebuild = Global("torch._utils", "_rebuild_tensor_v2"), storage = torch_bytes::Storage("0", 3);
  const std::string arguments = Tuple({storage, Int(0), Ints({3}), Ints({1}), "\x89", "}"});
  add("from-type", Dict({{"a", Call(Global("torch._tensor", "_rebuild_from_type_v2"),
                                    {rebuild, Global("torch.nn.parameter", "Parameter"), arguments, "}"})}}));
  add("typed", Dict({{"a", Call(Global("torch._utils", "_rebuild_tensor_v3"),
                                {storage, Int(0), Ints({3}), Ints({1}), "\x89", "}", Global("torch", "float16")})}}));
  const std::string viewed = Tuple({Text("storage"), Global("torch", "FloatStorage"), Text("0"), Text("cpu"), Int(3),
                                    Tuple({Text("v"), Int(1), Int(2)})}) +
                             'Q';
  add("viewed", Dict({{"a", Tensor(viewed, {{2}, {1}})}}));
  const std::string layer = Call(Global("torch.nn.modules.linear", "Linear"), {}) +
                            Dict({{"_parameters", Dict({{"weight", tensor}})}, {"_buffers", "}"}, {"_modules", "}"}}) +
                            'b';
  add("module",
      Call(Global("my.models", "Net"), {}) + Dict({{"_parameters", "}"}, {"_modules", Dict({{"fc", layer}})}}) + 'b');
  add("script", Call(Global("__torch__", "Net"), {}) + Dict({{"weight", tensor}, {"part", layer}}) + 'b');
  add("old-tensor",
      Dict({{"a", Call(Global("torch", "FloatTensor"), {}) + Tuple({storage, Int(0), Ints({3}), Ints({1})}) + 'b'}}));
}

void AddDatabase(const Corpus& corpus) {
  corpus.Add("database", "file", corpus.Written("d.db", [](const fs::path& path) {
    sqlite3* database = nullptr;
    sqlite3_open(path.c_str(), &database);
    sqlite3_exec(database,
                 "PRAGMA page_size = 512; CREATE TABLE images (image_id INTEGER PRIMARY KEY, name, camera_id);"
                 "CREATE TABLE keypoints (image_id INTEGER PRIMARY KEY, rows, cols, data);"
                 "INSERT INTO images VALUES (1, 'a.jpg', 1); INSERT INTO keypoints VALUES (1, 1, 2, zeroblob(8));",
                 nullptr, nullptr, nullptr);
    sqlite3_close(database);
  }));
  // Rows: the table, then a kind and a value for each column; a kind 6 k is the number k.
  const auto number = [](int k) { return std::string(1, static_cast<char>(6 * k)); };
  const auto blob = [](const std::string& bytes) { return '\4' + Big(bytes.size(), 1) + bytes; };
  const std::string pair = '\1' + Little(2147483647ull + 2, 8), floats(16, '\0');
  const std::string image = '\1' + number(1) + "\3\5a.jpg" + number(1);
  const std::string keypoints =
      '\2' + number(1) + number(2) + number(2) + blob(floats) + '\2' + number(2) + number(2) + number(2) + blob(floats);
  const std::string matches = '\3' + pair + number(1) + number(2) + blob(Little(0, 8));
  const std::string geometry = '\4' + pair + number(1) + number(2) + blob(Little(0, 8)) + number(4) + '\5' + '\5' +
                               blob(std::string(64, '\0') + Double(1));
  const std::string camera = std::string(1, '\0') + number(1) + number(2) + number(30) + number(20) +
                             blob(Double(1) + Double(2) + Double(3) + Double(0)) + number(0);
  corpus.Add("database", "rows", camera + image + keypoints + matches + geometry);
  corpus.Add("database", "camera", camera + image);
}

void AddWorkspace(const Corpus& corpus) {
  const nlohmann::json run = {{"program", "oraclegs"},
                              {"format", 1},
                              {"scene", "/scene"},
                              {"inputs", {"/a.zip"}},
                              {"start_iterations", 3000},
                              {"options", RunOptionsToJson(RunOptions{})},
                              {"size", {{"iterations", 7000}}}};
  corpus.Add("workspace", "options", run.dump());
  corpus.Add("config", "run", run.dump());
}

}  // namespace
}  // namespace oraclegs

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const oraclegs::Corpus corpus(argv[1]);
  oraclegs::AddColmap(corpus);
  oraclegs::AddDatasets(corpus);
  oraclegs::AddSplats(corpus);
  oraclegs::AddImages(corpus);
  oraclegs::AddWeights(corpus);
  oraclegs::AddPickles(corpus);
  oraclegs::AddDatabase(corpus);
  oraclegs::AddWorkspace(corpus);
  return 0;
}
