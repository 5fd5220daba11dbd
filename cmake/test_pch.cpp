// Compiled only to carry a precompiled header of the tests.
