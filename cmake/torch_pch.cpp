// Compiled only to carry the precompiled header of libtorch, which every torch-using target shares.
