// Writes the weights of small networks, for tests of the program from the outside, and for those that do without
// libtorch.
//   tiny_networks FOLDER [VARIANTS]

#include "networks/tiny_networks.h"

int main(int argc, char** argv) {
  if (argc < 2 || argc > 3) return 2;
  oraclegs::MakeTinyNetworks(argv[1]);
  if (argc == 3) oraclegs::MakeTinyVariants(argv[2]);
  return 0;
}
