#pragma once
// The container of binary glTF: its JSON, its bytes, and numbers out of both that are compared with what is there.

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace oraclegs {

class GlbFile {
 public:
  /// `bytes` must live as long as this. Throws InputError naming `file`, as all of this class: no binary glTF 2, chunks
  /// longer than the file.
  GlbFile(std::string_view bytes, std::string file);

  const std::string& file() const { return file_; }
  const nlohmann::json& json() const { return json_; }

  /// An item of one of the lists at the top ("nodes", "meshes").
  const nlohmann::json& Item(const char* list, int64_t index) const;
  /// A whole number of an object, 0 or more; `absent` where it has none.
  int64_t Integer(const nlohmann::json& object, const char* key, int64_t absent) const;
  /// The bytes of a buffer view.
  std::string_view View(int64_t index) const;

  /// How many items an accessor has, so long as its bytes hold them.
  int64_t Count(int64_t accessor) const;
  /// All numbers of an accessor of `components` each, row by row; integers as they are, or from their range to [0,1] or
  /// [-1,1] where they are normalized.
  std::vector<float> Floats(int64_t accessor, int components) const;

 private:
  struct Layout {
    std::string_view bytes;  // from the first item on
    int64_t count, stride;
    int type, components;
    bool normalized;
  };
  Layout LayoutOf(int64_t accessor) const;
  [[noreturn]] void Fail(const std::string& what) const;

  std::string file_;
  nlohmann::json json_;
  std::string_view bin_;
};

}  // namespace oraclegs
