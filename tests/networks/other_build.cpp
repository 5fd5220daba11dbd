// A library of networks that another build has made, for loader_test.cpp.

extern "C" const char* oraclegs_networks_build();
extern "C" const void* oraclegs_networks_create();

const char* oraclegs_networks_build() { return "0.0.0-of-another-build"; }

const void* oraclegs_networks_create() { return nullptr; }
