#!/usr/bin/env bash
# Builds the Debian packages and the tarball, from a build folder of their own, into build/package/packages.
#   packaging/build.sh
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/bootstrap.sh
cmake --preset package >/dev/null
cmake --build --preset package --parallel "$(nproc)"
packaging/check_hardening.sh build/package/bin/oraclegs build/package/lib/*.so
(cd build/package && cpack -G DEB && cpack -G TGZ) | sed -n 's/^CPack: - package: \(.*\) generated.$/\1/p'
