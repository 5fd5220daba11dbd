// Compiled only to carry the precompiled header that the floors without libtorch share.
