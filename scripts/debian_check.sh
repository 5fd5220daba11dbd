#!/usr/bin/env bash
# Builds this commit in a fresh Debian of another release, to see early what newer compilers and libraries refuse.
#   scripts/debian_check.sh RELEASE FOLDER          the networks and their tests, with that release's libtorch
#   scripts/debian_check.sh --bare RELEASE FOLDER   scripts/gpu_check.sh where there is nothing but g++, CMake, Ninja, python3,
#                                                   this machine's CUDA toolkit, and what scripts/gpu_pack.sh packs here
# RELEASE is trixie, sid, ...; FOLDER becomes the root of that Debian, and is used again when it is one. Needs root,
# mmdebstrap and 5 GB. Exit code 0 when all was built (and, of the first, all tests passed).
set -euo pipefail
usage() { sed -n '3,4s/^# */usage: /p' "$0" >&2; exit 2; }
bare=
[[ ${1:-} != --bare ]] || { bare=yes; shift; }
[[ $# == 2 && $1 != -* ]] || usage
release=$1 root=$2
((EUID == 0)) || { echo "scripts/debian_check.sh: run it as root, it changes the root folder" >&2; exit 2; }
command -v mmdebstrap > /dev/null || { echo "scripts/debian_check.sh: install mmdebstrap first" >&2; exit 2; }
# What is mounted below FOLDER is gone with this process, however it ends.
[[ -n ${ORACLEGS_OWN_MOUNTS:-} ]] || ORACLEGS_OWN_MOUNTS=yes exec unshare --mount "$0" ${bare:+--bare} "$@"
root=$(realpath -m -- "$root")
cd "$(dirname "$0")/.."

if [[ ! -e $root/etc/debian_version ]]; then
  mkdir -p "$root"
  mmdebstrap --variant=minbase "$release" "$root" http://deb.debian.org/debian
fi
inside() { chroot "$root" env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin ORACLEGS_JOBS="${ORACLEGS_JOBS:-$(nproc)}" "$@"; }
mkdir -p "$root/proc" "$root/dev"
mount -t proc proc "$root/proc"
mount --bind /dev "$root/dev"

install() { inside env DEBIAN_FRONTEND=noninteractive apt-get -q install -y --no-install-recommends "$@" < /dev/null; }
rm -rf "$root/oraclegs"
if [[ -n $bare ]]; then
  install g++ cmake ninja-build python3-minimal
  toolkit=$(realpath /usr/local/cuda)
  mkdir -p "$root$toolkit"
  mount --bind "$toolkit" "$root$toolkit"
  ln -sfn "$toolkit" "$root/usr/local/cuda"
  scripts/gpu_pack.sh "$root/root/pack"
  tar xzf "$root/root/pack/source.tar.gz" -C "$root"
  inside /oraclegs/scripts/gpu_check.sh --packages /root/pack/packages.tar.gz --seconds 3000 || true  # there is no GPU
  # What the check had no time for, and the exit code of all of it.
  inside cmake --build /oraclegs/build/cuda --parallel "${ORACLEGS_JOBS:-$(nproc)}" --target gpu_bench cuda_tests oraclegs
else
  listed=$(scripts/bootstrap.sh --libraries)
  mapfile -t libraries <<<"$listed"
  install g++ cmake ninja-build python3 pkg-config libtorch-dev libopenblas0-pthread "${libraries[@]}"
  git -c safe.directory='*' clone -q . "$root/oraclegs"
  inside bash -ec 'cd /oraclegs
    cmake -B build/networks -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_UNITY_BUILD=ON -DORACLEGS_NETWORKS=ON \
      -DORACLEGS_BENCH=OFF -DORACLEGS_PYTHON=OFF -DORACLEGS_WERROR=OFF
    cmake --build build/networks --parallel "$ORACLEGS_JOBS" --target networks_tests networks_torch_tests -- -k 0
    build/networks/bin/networks_tests --gtest_brief=1
    build/networks/bin/networks_torch_tests --gtest_brief=1'
fi
