#pragma once
// Tensors whose number of rows grows often: spare rows are kept behind the last one, as std::vector does.

#include "oraclegs/gaussians/gaussians.h"

namespace oraclegs {

/// `t` with `rows` >= t.size(0) rows, contiguous; the rows that were there keep their values, new ones hold anything.
/// When the storage of `t` has room, the result is a longer view of it (so hand in only tensors whose storage nobody
/// else uses); otherwise a copy in a storage half as large again.
Buffer<float> GrowRows(const Buffer<float>& t, int64_t rows);

/// GrowRows of each tensor.
void GrowRows(Gaussians* gaussians, int64_t rows);

/// Copies in storages of their own.
Gaussians Clone(const Gaussians& gaussians);

}  // namespace oraclegs
