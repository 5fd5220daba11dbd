#pragma once

#include <optional>
#include <string>

namespace oraclegs {

/// `--version`: ProgramText, then a line each of what computes and of the programs that are found here. Starts no
/// libtorch.
std::string VersionText();

/// "oraclegs 0.1.0 (commit 384d224)".
std::string ProgramText();

/// The short hash of the commit, with "-dirty" when files were changed; "unknown" outside of a git checkout.
std::string_view CommitText();

/// Instruction sets that are built and in use, and the number of threads.
std::string InstructionSetsText();

/// The versions of programs in PATH; nothing where there is no such program.
std::optional<std::string> ColmapVersion();
std::optional<std::string> FfmpegVersion();

}  // namespace oraclegs
