#pragma once
// Files as PyTorch writes them, byte by byte: pieces of pickles, zips, and the format before 1.6.

#include <cstdint>
#include <initializer_list>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace oraclegs::torch_bytes {

/// Little-endian.
inline std::string Bytes(uint64_t number, size_t width) {
  std::string bytes;
  for (size_t i = 0; i < width; ++i) bytes.push_back(i < sizeof(number) ? static_cast<char>(number >> (8 * i)) : '\0');
  return bytes;
}

// Pieces of pickles; each leaves one value on the stack.

inline std::string Text(const std::string& text) { return 'X' + Bytes(text.size(), 4) + text; }
inline std::string Int(int64_t number) { return "\x8a\x08" + Bytes(static_cast<uint64_t>(number), 8); }
inline std::string Global(const std::string& module, const std::string& name) {
  return 'c' + module + '\n' + name + '\n';
}
inline std::string Joined(const std::vector<std::string>& parts) {
  std::string all;
  for (const std::string& part : parts) all += part;
  return all;
}
inline std::string Tuple(const std::vector<std::string>& parts) { return '(' + Joined(parts) + 't'; }
inline std::string List(const std::vector<std::string>& parts) { return "](" + Joined(parts) + 'e'; }
inline std::string Ints(const std::vector<int64_t>& numbers) {
  std::string all = "(";
  for (const int64_t number : numbers) all += Int(number);
  return all + 't';
}
inline std::string Dict(const std::vector<std::pair<std::string, std::string>>& items) {
  std::string all = "}(";
  for (const auto& [key, value] : items) all += Text(key) + value;
  return all + 'u';
}
inline std::string Call(const std::string& function, const std::vector<std::string>& arguments) {
  return function + Tuple(arguments) + 'R';
}
inline std::string Pickle(const std::string& value) { return "\x80\x02" + value + '.'; }

inline std::string Storage(const std::string& key, int64_t numel, const std::string& type = "FloatStorage") {
  return Tuple({Text("storage"), Global("torch", type), Text(key), Text("cpu"), Int(numel)}) + 'Q';
}
struct View {
  std::vector<int64_t> shape, strides;
  int64_t offset = 0;
};
inline std::string Tensor(const std::string& storage, const View& view) {
  return Call(Global("torch._utils", "_rebuild_tensor_v2"),
              {storage, Int(view.offset), Ints(view.shape), Ints(view.strides), "\x89", "}"});
}
/// [numel] floats that are all of storage `key`.
inline std::string Vector(const std::string& key, int64_t numel) { return Tensor(Storage(key, numel), {{numel}, {1}}); }

inline std::string Floats(const std::vector<float>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)};
}

// Files.

using Parts = std::vector<std::pair<std::string, std::string>>;

/// A zip of parts that are stored as they are; with `wide`, their sizes and places are those of zip64.
inline std::string Zip(const Parts& parts, bool wide = false) {
  std::string file, table;
  for (const auto& [name, content] : parts) {
    const uint64_t at = file.size();
    file += "PK\3\4" + Bytes(20, 2) + Bytes(0, 12) + Bytes(content.size(), 4) + Bytes(content.size(), 4) +
            Bytes(name.size(), 2) + Bytes(0, 2) + name + content;
    const std::string extra =
        wide ? Bytes(1, 2) + Bytes(24, 2) + Bytes(content.size(), 8) + Bytes(content.size(), 8) + Bytes(at, 8) : "";
    const uint64_t size = wide ? 0xffffffff : content.size();
    table += "PK\1\2" + Bytes(20, 2) + Bytes(20, 2) + Bytes(0, 8) + Bytes(0, 4) + Bytes(size, 4) + Bytes(size, 4) +
             Bytes(name.size(), 2) + Bytes(extra.size(), 2) + Bytes(0, 10) + Bytes(wide ? 0xffffffff : at, 4) + name +
             extra;
  }
  const uint64_t begin = file.size(), count = parts.size();
  file += table;
  if (wide) {
    const uint64_t end = file.size();
    file += "PK\6\6" + Bytes(44, 8) + Bytes(45, 2) + Bytes(45, 2) + Bytes(0, 8) + Bytes(count, 8) + Bytes(count, 8) +
            Bytes(table.size(), 8) + Bytes(begin, 8);
    file += "PK\6\7" + Bytes(0, 4) + Bytes(end, 8) + Bytes(1, 4);
  }
  return file + "PK\5\6" + Bytes(0, 4) + Bytes(wide ? 0xffff : count, 2) + Bytes(wide ? 0xffff : count, 2) +
         Bytes(wide ? 0xffffffff : table.size(), 4) + Bytes(wide ? 0xffffffff : begin, 4) + Bytes(0, 2);
}

/// A checkpoint since PyTorch 1.6.
inline std::string ZipFile(const std::string& root, const std::map<std::string, std::string>& storages) {
  Parts parts = {{"archive/data.pkl", Pickle(root)}, {"archive/version", "3\n"}};
  for (const auto& [key, bytes] : storages) parts.emplace_back("archive/data/" + key, bytes);
  return Zip(parts);
}

/// A checkpoint before PyTorch 1.6; all storages hold floats.
inline std::string LegacyFile(const std::string& root, const std::map<std::string, std::string>& storages) {
  std::string keys = "](", data;
  for (const auto& [key, bytes] : storages) {
    keys += Text(key);
    data += Bytes(bytes.size() / sizeof(float), 8) + bytes;
  }
  return Pickle("\x8a\x0a\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19") + Pickle(Int(1001)) +
         Pickle(Dict({{"little_endian", "\x88"}})) + Pickle(root) + Pickle(keys + 'e') + data;
}

}  // namespace oraclegs::torch_bytes
