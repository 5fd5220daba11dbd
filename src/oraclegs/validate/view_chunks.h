#pragma once
// Choice of the proposals in one pass of VGGT, and of the view beside them (docs/method.md#vggt-oracle).

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "oraclegs/scene/loaded_view.h"
#include "oraclegs/validate/oracle.h"

namespace oraclegs {

/// [begin, end) of the fewest runs of at most `limit` elements, as even as possible. Empty for 0 elements.
std::vector<std::pair<size_t, size_t>> EvenRuns(size_t count, size_t limit);

/// The numbers 0 to count - 1 in random order, in EvenRuns of at most `limit`.
std::vector<std::vector<size_t>> ShuffledRuns(size_t count, size_t limit, uint64_t seed);

struct ViewChunk {
  std::vector<size_t> members;  ///< indices of proposals, ascending
  size_t reference = 0;         ///< training view beside them, held out from none of them
};

/// Plans chunks such that each query is in one. A chunk has queries of one source and size, in their order, at most
/// `limit`, and the training view whose camera is nearest to theirs, preferably one of their size. A chunk that holds
/// out every view is halved. Throws InputError when a query holds out the only view there is.
std::vector<ViewChunk> PlanChunks(const std::vector<Query>& queries, const std::vector<LoadedView>& views,
                                  size_t limit);

}  // namespace oraclegs
