#pragma once
// Which proposals VGGT looks at together, and beside which photograph.

#include <cstddef>
#include <utility>
#include <vector>

#include "oraclegs/scene/loaded_view.h"
#include "oraclegs/validate/oracle.h"

namespace oraclegs {

/// [begin, end) of as few runs as there can be of at most `most` things, as even as they can be. Nothing for 0 things.
std::vector<std::pair<size_t, size_t>> EvenRuns(size_t count, size_t most);

struct ViewChunk {
  std::vector<size_t> members;  ///< indices of proposals, ascending
  size_t reference = 0;         ///< the photograph beside them; hidden from none of them
};

/// Each proposal in one chunk: those of one source and size, in their order, at most `most` together, beside the
/// photograph whose camera is nearest to theirs; of the photographs of their size, where one is free. A chunk that
/// hides every photograph is halved. Throws InputError when a proposal hides the only photograph there is.
std::vector<ViewChunk> PlanChunks(const std::vector<HiddenPhotograph>& hidden, const std::vector<LoadedView>& photos,
                                  size_t most);

}  // namespace oraclegs
