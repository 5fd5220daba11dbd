#pragma once
// Which proposals VGGT looks at together, and beside which view (docs/method.md#vggt-oracle).

#include <cstddef>
#include <utility>
#include <vector>

#include "oraclegs/scene/loaded_view.h"
#include "oraclegs/validate/oracle.h"

namespace oraclegs {

/// [begin, end) of as few runs as there can be of at most `limit` things, as even as they can be. Nothing for 0 things.
std::vector<std::pair<size_t, size_t>> EvenRuns(size_t count, size_t limit);

struct ViewChunk {
  std::vector<size_t> members;  ///< indices of proposals, ascending
  size_t reference = 0;         ///< the training view beside them; held out from none of them
};

/// Each query in one chunk: those of one source and size, in their order, at most `limit` together, beside the training
/// view whose camera is nearest to theirs; of the views of their size, where there is one. A chunk that holds every
/// view out is halved. Throws InputError when a query holds out the only view there is.
std::vector<ViewChunk> PlanChunks(const std::vector<Query>& queries, const std::vector<LoadedView>& views,
                                  size_t limit);

}  // namespace oraclegs
