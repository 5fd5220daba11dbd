#!/usr/bin/env bash
# Builds the Debian packages and the tarball, from a build folder of their own, into build/package/packages.
#   packaging/build.sh
# With nvcc (the CUDA toolkit from 12.0 on), also the package for NVIDIA GPUs.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/bootstrap.sh
PATH=$PATH:/usr/local/cuda/bin
cuda=ON
if ! command -v nvcc >/dev/null; then
  cuda=OFF
  echo "packaging/build.sh: there is no nvcc: without the package oraclegs-cuda" >&2
fi
cmake --preset package -DORACLEGS_CUDA=$cuda >/dev/null
cmake --build --preset package --parallel "$(nproc)"
packaging/check_hardening.sh build/package/bin/oraclegs build/package/lib/*.so
(cd build/package && cpack -G DEB && cpack -G TGZ) | sed -n 's/^CPack: - package: \(.*\) generated.$/\1/p'
