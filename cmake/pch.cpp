// Compiled only to carry a precompiled header.
