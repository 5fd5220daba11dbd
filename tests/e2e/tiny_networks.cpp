// Writes the weights of small networks, for tests of the program from the outside.
//   tiny_networks FOLDER

#include "support/tiny_networks.h"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  oraclegs::WriteTinyNetworks(argv[1]);
  return 0;
}
