// Runs every target over its committed corpus: fuzz_replay CORPUS_FOLDER. Without libFuzzer, for any compiler.

#include <cstdio>
#include <fstream>
#include <iterator>
#include <map>

#include "fuzz/fuzz.h"

namespace oraclegs::fuzz {
namespace {

namespace fs = std::filesystem;

std::map<std::string, Target>& Targets() {
  static std::map<std::string, Target> targets;
  return targets;
}

std::string Content(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

bool Passes(Target target, const fs::path& path) {
  try {
    target(Content(path));
    return true;
  } catch (const Finding&) {  // it has been shown
  } catch (const std::exception& error) {
    std::fprintf(stderr, "finding: %s\n", error.what());
  }
  std::fprintf(stderr, "  in %s\n", path.c_str());
  return false;
}

int Replay(const fs::path& corpus) {
  SetNumThreads(1);
  int files = 0, findings = 0;
  for (const auto& [name, target] : Targets()) {
    int of_target = 0;
    std::error_code missing;
    for (const auto& entry : fs::directory_iterator(corpus / name, missing)) {
      ++of_target;
      findings += Passes(target, entry.path()) ? 0 : 1;
    }
    if (of_target == 0) {
      std::fprintf(stderr, "%s: has no files\n", (corpus / name).c_str());
      ++findings;
    }
    files += of_target;
  }
  std::printf("%zu targets, %d files, %d findings\n", Targets().size(), files, findings);
  return findings == 0 ? 0 : 1;
}

}  // namespace

bool AddTarget(const char* name, Target target) { return Targets().emplace(name, target).second; }

}  // namespace oraclegs::fuzz

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: fuzz_replay CORPUS_FOLDER\n");
    return 2;
  }
  return oraclegs::fuzz::Replay(argv[1]);
}
