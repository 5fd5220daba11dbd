// .splat, and the choice of a reader by the end of a name, which is the first line of the bytes.

#include "fuzz/fuzz.h"
#include "oraclegs/formats/codecs.h"
#include "oraclegs/formats/splat_file.h"

ORACLEGS_FUZZ_TARGET(splat) {
  using namespace oraclegs;
  fuzz::Try([&] { DecodeSplat(bytes, "f"); });
  const size_t line = bytes.find('\n');
  if (line == std::string_view::npos || line > 32) return;
  std::string name(bytes.substr(0, line));
  for (char& c : name) c = c == '/' || c == '\0' ? '_' : c;
  try {
    SplatFormatOf("a" + name);
  } catch (const UsageError&) {
    return;
  }
  static const fuzz::Folder folder;
  fuzz::Try([&] { ReadSplat(folder.Put("a" + name, bytes.substr(line + 1))); });
}
