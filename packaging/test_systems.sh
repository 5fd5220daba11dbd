#!/usr/bin/env bash
# Builds this commit in a bare system of another kind and runs the demo there: what newer compilers and libraries refuse. Needs
# root (mmdebstrap makes the system below a temporary folder, which is removed afterwards), a mirror and 4 GB; takes as long as
# a build.
#   packaging/test_systems.sh debian-13|ubuntu-24.04
# DEBIAN_MIRROR, UBUNTU_MIRROR: instead of http://deb.debian.org, http://archive.ubuntu.com. ORACLEGS_JOBS: compilers at a time
set -euo pipefail
cd "$(dirname "$0")/.."
source packaging/bare_system.sh

system=${1:-}
listed=$(scripts/bootstrap.sh --libraries)
mapfile -t packages <<<"$listed"
packages+=(g++ cmake ninja-build pkg-config python3-minimal libopenvdb-dev libboost-dev nodejs)
case $system in
  debian-13)
    mapfile -t mirrors < <(debian trixie)
    bare_system "Debian 13" trixie "${mirrors[@]}"
    ;;
  ubuntu-24.04)
    mirror=${UBUNTU_MIRROR:-http://archive.ubuntu.com}/ubuntu
    keys=/usr/share/keyrings/ubuntu-archive-keyring.gpg
    [[ -e $keys ]] || {
      echo "packaging/test_systems.sh: $keys is missing; it is in Ubuntu's package ubuntu-keyring" >&2
      exit 1
    }
    bare_system "Ubuntu 24.04" noble --keyring="$keys" "deb $mirror noble main universe" \
      "deb $mirror noble-updates main universe" "deb $mirror noble-security main universe"
    ;;
  *)
    sed -n '5s/^# */usage: /p' "$0" >&2
    exit 2
    ;;
esac

step "what it is built from"
install --no-install-recommends "${packages[@]}"
inside g++ --version | head -n 1

step build
commit=$(git -c safe.directory='*' rev-parse --short=12 HEAD)
mkdir "$root/oraclegs"
git -c safe.directory='*' archive HEAD | tar -x -C "$root/oraclegs"
[[ ! -d web/node_modules ]] || cp -a web/node_modules "$root/oraclegs/web/"  # as scripts/bootstrap.sh installed them here
inside sh -ec 'cd /oraclegs
  cmake --preset release -DORACLEGS_WERROR=OFF -DORACLEGS_TESTS=OFF -DORACLEGS_BENCH=OFF -DORACLEGS_COMMIT='"$commit"' >/tmp/configured
  cmake --build --preset release --parallel '"${ORACLEGS_JOBS:-$(nproc)}"
inside grep -i without /tmp/configured || true

step "oraclegs demo"
inside /oraclegs/build/release/bin/oraclegs --version
inside sh -c 'cd /tmp && /oraclegs/build/release/bin/oraclegs demo --quiet'
inside test -s /tmp/oraclegs-demo/demo.png
inside test -s /tmp/oraclegs-demo/run/report.html
inside /oraclegs/build/release/bin/oraclegs mesh /tmp/oraclegs-demo/run -o /tmp/out.glb --quiet  # OpenVDB
step passed
