#!/usr/bin/env bash
# Packs what scripts/gpu_check.sh needs on a machine that has an NVIDIA GPU but neither our libraries nor a package registry.
#   scripts/gpu_pack.sh FOLDER
# writes FOLDER/source.tar.gz (this checkout without the reference numbers of the networks) and FOLDER/packages.tar.gz
# (headers and libraries, from packages of this machine's Debian or Ubuntu), prints their sizes and how to go on.
# That machine needs the CUDA toolkit, CMake, Ninja, g++ and python3; its C and C++ libraries must not be older than ours.
set -euo pipefail
(($# == 1)) || { echo "usage: scripts/gpu_pack.sh FOLDER" >&2; exit 2; }
mkdir -p "$1"
folder=$(cd "$1" && pwd)
cd "$(dirname "$0")/.."

libraries=$(scripts/bootstrap.sh --libraries)  # a failure of it ends this script, too
mapfile -t packages <<<"$libraries"
packages+=(pkgconf)
# What every machine with a C++ compiler has, and what our libraries name but never load.
everywhere='^(lib(c6|c-dev-bin|c6-dev|crypt1|crypt-dev|nsl2|nsl-dev|tirpc.*|gcc-s1|stdc\+\+6)|gcc-.*|linux-libc-dev|rpcsvc-proto'
everywhere+='|catch2|googletest|libdb5\.3|libsasl2-modules-db|libdpkg-perl|perl.*|dpkg.*|debconf.*|cdebconf)(t64)?$'
golden_of_networks='^tests/golden/(depth_anything|lpips|openclip|sd21|seva|vggt)'

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/debs" "$work/root" "$work/packages"

apt-cache depends --recurse --no-recommends --no-suggests --no-conflicts --no-breaks --no-replaces --no-enhances "${packages[@]}" |
  grep -E '^[a-z0-9][a-z0-9.+-]*$' | sort -u | grep -vE "$everywhere" > "$work/names"
(cd "$work/debs" && xargs apt-get download -qq < "$work/names" 2> "$work/apt.log") || { cat "$work/apt.log" >&2; exit 1; }
for deb in "$work"/debs/*.deb; do dpkg-deb -x "$deb" "$work/root"; done

# Headers, libraries, and the files by which CMake and pkg-config find them; no archive where there is a shared library.
multiarch=$(basename "$(dirname "$(find "$work/root/usr/lib" -name 'libfmt.so' | head -n 1)")")
usr=$work/packages/usr
lib=$usr/lib/$multiarch
mkdir -p "$lib" "$usr/bin" "$usr/share"
cp -a "$work/root/usr/include" "$usr"
[[ ! -d $usr/include/$multiarch ]] || cp -a "$usr/include/$multiarch"/. "$usr/include"  # where not only Debian's compilers look
for from in "$work/root/lib/$multiarch" "$work/root/usr/lib/$multiarch"; do
  [[ ! -d $from ]] || cp -a "$from"/. "$lib"
done
for from in cmake pkgconfig eigen3; do
  [[ ! -d $work/root/usr/share/$from ]] || cp -a "$work/root/usr/share/$from" "$usr/share"
done
[[ ! -d $work/root/usr/lib/cmake ]] || cp -a "$work/root/usr/lib/cmake" "$usr/lib"
cp -a "$work"/root/usr/bin/pkgconf "$usr/bin"
find "$lib" -name '*.a' | while read -r archive; do
  [[ ! -e ${archive%.a}.so && ! -L ${archive%.a}.so ]] || rm "$archive"
done
# Folders beside the libraries hold plugins, but for these and for headers that differ by machine (GLib's).
find "$lib" -mindepth 1 -maxdepth 1 -type d ! -name cmake ! -name pkgconfig | while read -r subfolder; do
  [[ -d $subfolder/include ]] || rm -r "$subfolder"
done
find "$lib" -maxdepth 1 -type l -lname '/*' | while read -r link; do ln -sfn "$(basename "$(readlink "$link")")" "$link"; done

tar czf "$folder/packages.tar.gz" -C "$work/packages" usr
{ git ls-files 2>/dev/null || find . -type f ! -path './build/*' -printf '%P\n'; } | grep -vE "$golden_of_networks" |
  while read -r file; do [[ ! -e $file ]] || echo "$file"; done |
  tar czf "$folder/source.tar.gz" --transform 's,^,oraclegs/,' -T -
size() { echo "$(($(stat -c %s "$1") / 1024)) KiB"; }
cat <<END
$folder/source.tar.gz    $(size "$folder/source.tar.gz"), without tests/golden/{depth_anything,lpips,openclip,sd21,seva,vggt}*
$folder/packages.tar.gz  $(size "$folder/packages.tar.gz"), $(wc -l < "$work/names") packages
Carry both to the machine with the GPU; there:
  tar xzf source.tar.gz && oraclegs/scripts/gpu_check.sh --packages packages.tar.gz
END
