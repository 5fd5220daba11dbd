#pragma once
// Runs the instructions of a checkpoint's pickle. A pickle is a program for a small machine; this one knows the
// instructions by which PyTorch writes checkpoints and refuses every other, and what it makes is data: no name is
// looked up, nothing is called.

#include <string_view>

#include "oraclegs/weights/checkpoint/pickle_heap.h"

namespace oraclegs {

/// Reads one pickle from the beginning of `*bytes`, which then begins behind it. Time and memory grow with its length
/// alone. Throws InputError with heap->file for a pickle that is damaged, needs an unknown instruction, or is larger
/// than any of a checkpoint.
PickleValue ReadPickle(std::string_view* bytes, PickleHeap* heap);

}  // namespace oraclegs
