# Sourced by the tests in a system of their own: bare_system makes one in a temporary folder, $root, which is removed when the
# script ends. Needs root, mmdebstrap and a mirror. The script's folder is the repository's.

# bare_system NAME RELEASE MIRROR_LINES...: the smallest system with apt, with the lists of its packages.
bare_system() {
  local tool name=$1 release=$2
  shift 2
  for tool in mmdebstrap dpkg-deb chroot; do
    command -v "$tool" >/dev/null || {
      echo "$0: $tool is missing; apt-get install mmdebstrap dpkg" >&2
      exit 1
    }
  done
  ((EUID == 0)) || {
    echo "$0: run it as root, it makes a system in a folder" >&2
    exit 1
  }
  step "a bare $name"
  root=$(mktemp -d /tmp/oraclegs-root.XXXXXX)
  trap clean_up EXIT
  mmdebstrap --quiet --variant=apt --mode=root "$release" "$root" "$@"
  mount -t proc proc "$root/proc"
  mount --bind /dev "$root/dev"
  cp --remove-destination /etc/resolv.conf "$root/etc/resolv.conf"
  inside apt-get -q update >/dev/null
}

clean_up() {
  local mounted
  for mounted in proc dev; do
    if mountpoint -q "$root/$mounted"; then umount "$root/$mounted"; fi
  done
  rm -rf --one-file-system "$root"
}

step() { echo "== $1 (${SECONDS} s)"; }
inside() { env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive chroot "$root" "$@"; }

# install PACKAGES...: quietly, unless it fails
install() { inside apt-get -q -y install "$@" >"$root/tmp/log" 2>&1 </dev/null || { tail -n 30 "$root/tmp/log" >&2; exit 1; }; }

# debian RELEASE: the lines of its mirrors
debian() {
  local mirror=${DEBIAN_MIRROR:-http://deb.debian.org}
  printf 'deb %s main\n' "$mirror/debian $1" "$mirror/debian $1-updates" "$mirror/debian-security $1-security"
}
