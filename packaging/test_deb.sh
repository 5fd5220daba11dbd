#!/usr/bin/env bash
# Installs the packages in a bare Debian 12 and runs them there: a test of what they depend on. Needs root (mmdebstrap makes
# the system below a temporary folder, which is removed afterwards) and a Debian mirror; takes some minutes.
#   packaging/test_deb.sh [--networks] [FOLDER_OF_PACKAGES]     FOLDER: build/package/packages
# --networks also installs oraclegs-networks, which brings libtorch: 400 MB more. Where oraclegs-cuda was built, it is installed
# and has to say what it lacks; with build/release beside it, the installed program also runs on the emulated GPU of the tests.
set -euo pipefail
cd "$(dirname "$0")/.."
source packaging/bare_system.sh

networks=
if [[ ${1:-} == --networks ]]; then
  networks=yes
  shift
fi
packages=$(realpath "${1:-build/package/packages}")
compgen -G "$packages/oraclegs_*.deb" >/dev/null || {
  echo "packaging/test_deb.sh: no oraclegs_*.deb in $packages; run packaging/build.sh first" >&2
  exit 1
}

# sizes_of PACKAGES...: what apt would install, in MB on disk and MB to download.
sizes_of() {
  inside apt-get -s -y install "$@" >"$root/tmp/simulated"
  inside sh -c 'awk "/^Inst/ { print \$2 }" /tmp/simulated | grep -v ^oraclegs |
    xargs --no-run-if-empty apt-cache show --no-all-versions' |
    awk '/^Package:/ { n++ } /^Installed-Size:/ { disk += $2 / 1024 } /^Size:/ { load += $2 / 1e6 }
         END { printf "%d packages, %.0f MB on disk, %.0f MB to download", n, disk, load }'
}

mapfile -t mirrors < <(debian bookworm)
bare_system "Debian 12" bookworm "${mirrors[@]}"
mkdir "$root/packages"
cp "$packages"/*.deb "$root/packages"

deb=$(cd "$root" && ls packages/oraclegs_*.deb)
echo "colmap alone brings:           $(sizes_of colmap)"
echo "/$deb brings: $(sizes_of "/$deb")"
step "apt install /$deb"
install "/$deb"
echo "with colmap there:             $(inside du -sm --apparent-size /usr/lib/x86_64-linux-gnu/oraclegs /usr/bin/oraclegs | awk '{ s += $1 } END { print s }') MB are oraclegs itself"
if [[ -n $networks ]]; then
  step "apt install oraclegs-networks"
  echo "brings: $(sizes_of "/$(cd "$root" && ls packages/oraclegs-networks_*.deb)")"
  install "/$(cd "$root" && ls packages/oraclegs-networks_*.deb)"
  inside oraclegs --version | grep libtorch
fi

step "oraclegs --version"
inside oraclegs --version
inside test -s /usr/share/man/man1/oraclegs.1.gz
inside test -s /usr/share/bash-completion/completions/oraclegs
inside test -s /usr/share/doc/oraclegs/THIRD_PARTY_NOTICES.md

if compgen -G "$packages/oraclegs-cuda_*.deb" >/dev/null; then
  cuda=/$(cd "$root" && ls packages/oraclegs-cuda_*.deb)
  step "apt install $cuda"
  echo "brings: $(sizes_of "$cuda")"
  inside apt-get -q -y install "$cuda" >"$root/tmp/log" 2>&1 || { tail -n 30 "$root/tmp/log" >&2; exit 1; }
  echo "is itself $(du -m --apparent-size "$root"/usr/lib/*/oraclegs/liboraclegs_cuda.so | cut -f1) MB"
  inside oraclegs --version | grep '^cuda  *[0-9]'
  inside oraclegs demo-scene /tmp/tiny --demo-views 6 --width 96 --height 72 --samples 1 --quiet
  small=(reconstruct /tmp/tiny -o /tmp/tiny_out --init random --proposers none --iterations 30 --max-gaussians 500 --set random-points=400)
  if [[ ! -e /proc/driver/nvidia/version ]]; then
    { inside oraclegs "${small[@]}" --device cuda 2>&1 || true; } | tail -n 1 | tee "$root/tmp/log"
    grep -q 'no NVIDIA GPU with a working driver' "$root/tmp/log"
  fi
  emulated=build/release/lib/liboraclegs_cuda_emulated.so
  if [[ -e $emulated ]]; then
    cp "$emulated" "$root/tmp/"
    inside env ORACLEGS_CUDA_LIBRARY=/tmp/liboraclegs_cuda_emulated.so oraclegs "${small[@]}" --device cuda 2>&1 | grep 'on the GPU'
  fi
fi

step "photos without poses: registered by colmap"
inside oraclegs demo-scene /tmp/scene --demo-views 8 --quiet
inside oraclegs reconstruct /tmp/scene/images -o /tmp/out --quality draft --iterations 100 --quiet
inside test -s /tmp/out/point_cloud.ply
inside oraclegs mesh /tmp/out -o /tmp/out.glb --quiet  # OpenVDB

step "oraclegs demo"
inside sh -c 'cd /tmp && oraclegs demo --quiet'
inside test -s /tmp/oraclegs-demo/demo.png
inside test -s /tmp/oraclegs-demo/run/report.html

step "apt remove"
inside apt-get -q -y purge 'oraclegs*' >"$root/tmp/log" 2>&1
left=$(inside find /usr /etc -xdev -path /usr/share/doc -prune -o -name '*oraclegs*' -print)
[[ -z $left ]] || { echo "left behind: $left" >&2; exit 1; }
step "passed"
