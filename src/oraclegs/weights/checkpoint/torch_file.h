#pragma once
// Files of torch.save: a zip of a pickle and of one part for each storage since PyTorch 1.6, five pickles and the
// storages before. TorchScript archives are such zips, too.

#include <string_view>

#include "oraclegs/weights/checkpoint/pickle_heap.h"

namespace oraclegs {

/// True for files that begin as one of PyTorch's.
bool LooksLikeTorchFile(std::string_view bytes);

/// Reads the pickles of the file, which must outlive the heap, and finds the bytes of its storages. Returns what was
/// saved. Throws InputError with heap->file.
PickleValue ReadTorchFile(std::string_view bytes, PickleHeap* heap);

}  // namespace oraclegs
