#!/usr/bin/env bash
# Builds for 64-bit ARM on an x86-64 Debian 12 with Debian's cross compiler, runs the tests and a demo under qemu, and makes
# packages. Installs the compiler and qemu when they are missing; arm64's libraries go into build/arm64-sysroot alone.
#   packaging/arm64.sh            all of it, an hour or more; the packages are in build/arm64/packages
#   packaging/arm64.sh --build    only the program
#   packaging/arm64.sh --tests    the program and the tests, run
# ORACLEGS_JOBS: how much runs side by side. DEBIAN_MIRROR: instead of http://deb.debian.org
set -euo pipefail
cd "$(dirname "$0")/.."

only=${1:-}
[[ $# -le 1 && $only =~ ^(|--build|--tests)$ ]] || {
  sed -n '4,6s/^# */usage: /p' "$0" >&2
  exit 2
}
jobs=${ORACLEGS_JOBS:-$(nproc)}
sysroot=$PWD/build/arm64-sysroot
step() { echo "== $1 (${SECONDS} s)"; }

missing=()
command -v aarch64-linux-gnu-g++ >/dev/null || missing+=(g++-aarch64-linux-gnu)
command -v qemu-aarch64-static >/dev/null || command -v qemu-aarch64 >/dev/null || missing+=(qemu-user-static)
if ((${#missing[@]} > 0)); then
  step "install ${missing[*]}"
  as_root=()
  ((EUID == 0)) || as_root=(sudo)
  "${as_root[@]}" apt-get -q update </dev/null
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q install -y --no-install-recommends "${missing[@]}" </dev/null
fi

# The folder of an apt that knows arm64 alone: nothing changes for this machine's.
apt_folder=$sysroot/apt
arm64_apt() {
  apt-get -q -o APT::Architecture=arm64 -o APT::Architectures=arm64 -o APT::Sandbox::User= -o Debug::NoLocking=1 \
    -o Dir::State="$apt_folder" -o Dir::State::status="$apt_folder/status" -o Dir::Cache="$apt_folder" \
    -o Dir::Etc::sourcelist="$apt_folder/sources.list" -o Dir::Etc::sourceparts=- -o Dir::Etc::preferencesparts=/dev/null "$@" </dev/null
}

# make_sysroot PACKAGES...: what they hold, and what they depend on; no script of theirs runs.
make_sysroot() {
  step "arm64's libraries"
  rm -rf "$sysroot"
  mkdir -p "$apt_folder"/{lists,archives}/partial "$sysroot"/usr/{bin,lib,sbin}
  ln -s usr/{bin,lib,sbin} "$sysroot"
  local mirror=${DEBIAN_MIRROR:-http://deb.debian.org}
  : >"$apt_folder/status"
  printf 'deb %s bookworm%s main\n' "$mirror/debian" "" "$mirror/debian" -updates "$mirror/debian-security" -security \
    >"$apt_folder/sources.list"
  arm64_apt update >/dev/null
  arm64_apt install -y --no-install-recommends --download-only "$@" >/dev/null
  local package link target
  for package in "$apt_folder"/archives/*.deb; do
    dpkg-deb --fsys-tarfile "$package" | tar -x --keep-directory-symlink -C "$sysroot" --exclude=./usr/share/{doc,man,locale}
    dpkg-deb --ctrl-tarfile "$package" | tar -xO ./shlibs 2>/dev/null >>"$sysroot/shlibs" || true  # programs have none
  done
  rm "$apt_folder"/archives/*.deb
  find "$sysroot" -type l -lname '/*' -printf '%p\t%l\n' | while IFS=$'\t' read -r link target; do
    ln -sfnr "$sysroot$target" "$link"
  done
}

listed=$(scripts/bootstrap.sh --libraries)
mapfile -t libraries <<<"$listed"
libraries+=(libopenvdb-dev libboost-dev libstdc++-12-dev)
if [[ $(cat "$sysroot/made_of" 2>/dev/null) != "${libraries[*]}" ]]; then
  make_sysroot "${libraries[@]}"
  echo "${libraries[*]}" >"$sysroot/made_of"
fi

step build
configure=()
[[ ${CI:-} != true ]] || configure+=(-DORACLEGS_WERROR=ON)
cmake --preset arm64 "${configure[@]}" >/dev/null
cmake --build --preset arm64 --parallel "$jobs" --target oraclegs
[[ $only != --build ]] || exit 0

# The floors below the pipeline. Emulated, stereo and poses take tens of minutes.
floors=(core image camera scene capture sfm demo depth gaussians formats datasets render loss train propose mesh)
# What fails for a reason of qemu, which is a program among programs of another machine:
not_emulated=(
  # the test program starts itself anew, which qemu leaves to a kernel that knows no arm64 program
  ParallelFor.WorksInAForkedChildAndEndsWithIt
  Signals/DeadlyInterrupt.TheSecondSignalEndsTheProcess/*
)
cmake --build --preset arm64 --parallel "$jobs" --target "${floors[@]/%/_tests}"
step "tests under qemu"
OMP_WAIT_POLICY=passive GTEST_BRIEF=1 GTEST_FILTER="-$(IFS=:; echo "${not_emulated[*]}")" \
  ctest --preset arm64 --parallel "$jobs" --no-tests=error --timeout 3000 -R "^($(IFS='|'; echo "${floors[*]}"))\$"
awk '/^\[  PASSED  \]/ { n += $4 } END { printf "%d tests passed under qemu\n", n }' build/arm64/Testing/Temporary/LastTest.log
echo "left out: ${not_emulated[*]:-none}"
[[ $only != --tests ]] || exit 0

step "demo under qemu"
qemu=$(command -v qemu-aarch64-static || command -v qemu-aarch64)
work=$(mktemp -d /tmp/oraclegs-arm64.XXXXXX)
trap 'rm -rf "$work"' EXIT
"$qemu" -L "$sysroot" build/arm64/bin/oraclegs demo --width 96 --height 72 --views 4 --iterations 50 --quiet -o "$work/demo"
test -s "$work/demo/demo.png"
test -s "$work/demo/run/report.html"

step packages
cmake --build --preset arm64 --parallel "$jobs" --target oraclegs oraclegs_pages
packaging/check_hardening.sh build/arm64/bin/oraclegs build/arm64/lib/liboraclegs_{core,openvdb}.so
# What dpkg-shlibdeps finds on the machine it builds for: the packages of the libraries that are named in what is installed.
names=$(readelf -d build/arm64/bin/oraclegs build/arm64/lib/liboraclegs_{core,openvdb}.so |
  sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p' | sort -u | grep -v -e ^liboraclegs_ -e ^ld-linux)
depends=colmap
for name in $names; do
  found=$(awk -v name="$name" '$1 ".so." $2 == name || $1 "-" $2 ".so" == name { sub(/^[^ ]+ +[^ ]+ +/, ""); print; exit }' "$sysroot/shlibs")
  [[ -n $found ]] || { echo "packaging/arm64.sh: no package of the sysroot has $name" >&2; exit 1; }
  [[ ", $depends, " == *", $found, "* ]] || depends+=", $found"
done
(cd build/arm64 && cpack -G DEB -D CPACK_DEBIAN_PACKAGE_SHLIBDEPS=OFF -D CPACK_DEBIAN_RUNTIME_PACKAGE_DEPENDS="$depends") |
  sed -n 's/^CPack: - package: \(.*\) generated.$/\1/p'
deb=$(ls build/arm64/packages/oraclegs_*_arm64.deb)
dpkg-deb -f "$deb" Package Version Architecture Installed-Size Depends
arm64_apt update >/dev/null
step "what apt would install for $deb on a bare arm64 Debian 12"
arm64_apt install -s -y "$(realpath "$deb")" | grep -E '^[0-9]+ upgraded'
dpkg-deb -x "$deb" "$work/root"
"$qemu" -L "$sysroot" "$work/root/usr/bin/oraclegs" --version
step passed
