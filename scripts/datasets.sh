#!/usr/bin/env bash
# Fetches public datasets in the layout that `oraclegs bench` reads.
#
#   scripts/datasets.sh [options] NAME...     into DATASETS/NAME/SCENE/
#
#   NAME           fox (the scene of docs/tutorial.md), mipnerf360, blender, llff, dtu, or all
#   --to DATASETS  the folder that gets them; ./datasets unless given
#   --scenes A,B   these scenes alone
#   --from URL     a place (http://, file://) that has the archives under their own names, instead of the public ones;
#                  also ORACLEGS_DATASETS_URL
#   --keep         keeps the archives, in DATASETS/.archives
#   --list         what there is and where it comes from
#
# A download that was cut off goes on with the same command; a scene that is there is not fetched again. Archives whose
# SHA-256 is known are checked. Of the others (fox, Mip-NeRF 360, DTU) nobody has published one: that of the first download
# is written to DATASETS/NAME/ARCHIVE.sha256, and later ones are checked against it.
# Needs curl and python3. The datasets have licenses of their own; the pages that --list names have them.
set -euo pipefail

fail() {
  echo "scripts/datasets.sh: $1" >&2
  exit "${2:-4}"
}

usage() { sed -n '2,/^# Needs/s/^# \{0,1\}//p' "$0"; }

google=https://storage.googleapis.com/gresearch/refraw360
mirror=https://github.com/yxlao/nerfmirror/releases/download/20220618
dtu=http://roboimagedata2.compute.dtu.dk/data/MVS

# archive, URL, SHA-256 or "-"
archives_of() {
  case $1 in
    fox) echo "instant-ngp.zip https://codeload.github.com/NVlabs/instant-ngp/zip/refs/heads/master -" ;;
    mipnerf360) echo "360_v2.zip $google/360_v2.zip -" ;;
    blender) echo "nerf_synthetic.zip $mirror/nerf_synthetic.zip f01fd1b4ab045b0d453917346f26f898657bb5bec4834b95fdad1f361826e45e" ;;
    llff) echo "nerf_llff_data.zip $mirror/nerf_llff_data.zip 5794b432feaf4f25bcd603addc6ad0270cec588fed6a364b7952001f07466635" ;;
    dtu)
      echo "SampleSet.zip $dtu/SampleSet.zip -"  # the cameras
      echo "Rectified.zip $dtu/Rectified.zip -"
      ;;
  esac
}

scenes_of() {
  case $1 in
    fox) echo fox ;;
    mipnerf360) echo bicycle bonsai counter garden kitchen room stump ;;
    blender) echo chair drums ficus hotdog lego materials mic ship ;;
    llff) echo fern flower fortress horns leaves orchids room trex ;;
    dtu) echo scan8 scan21 scan30 scan31 scan34 scan38 scan40 scan41 scan45 scan55 scan63 scan82 scan103 scan110 scan114 ;;
  esac
}

page_of() {
  case $1 in
    fox) echo "https://github.com/NVlabs/instant-ngp" ;;
    mipnerf360) echo "https://jonbarron.info/mipnerf360/" ;;
    blender | llff) echo "https://www.matthewtancik.com/nerf" ;;
    dtu) echo "https://roboimagedata.compute.dtu.dk/?page_id=36" ;;
  esac
}

all=(fox mipnerf360 blender llff dtu)
to=datasets from=${ORACLEGS_DATASETS_URL:-} keep=0 wanted= names=()
while (($# > 0)); do
  case $1 in
    --help | -h)
      usage
      exit 0
      ;;
    --list)
      for name in "${all[@]}"; do
        echo "$name: $(page_of "$name")"
        echo "  scenes: $(scenes_of "$name")"
        while read -r archive url sum; do
          if [[ $sum == - ]]; then sum="no checksum is published"; else sum="sha256 $sum"; fi
          echo "  $url ($sum)"
        done < <(archives_of "$name")
      done
      exit 0
      ;;
    --to | --from | --scenes)
      (($# > 1)) || fail "$1 needs a value" 2
      case $1 in
        --to) to=$2 ;;
        --from) from=$2 ;;
        --scenes) wanted=${2//,/ } ;;
      esac
      shift
      ;;
    --keep) keep=1 ;;
    all) names+=("${all[@]}") ;;
    -*) fail "there is no option $1; --help lists them" 2 ;;
    *)
      [[ -n $(archives_of "$1") ]] || fail "there is no dataset '$1'; there are ${all[*]}" 2
      names+=("$1")
      ;;
  esac
  shift
done
((${#names[@]} > 0)) || fail "name a dataset: ${all[*]}, or all; --help says more" 2
for program in curl python3 sha256sum; do
  command -v "$program" >/dev/null || fail "$program is not in PATH; install it"
done

# Whether DATASETS has room for so many bytes.
need_room() {
  local free
  free=$(df --output=avail -B1 "$to" | tail -n 1)
  if ((free < $1)); then
    fail "$to: $2 needs $(($1 / 1000000 + 1)) MB and $((free / 1000000)) MB are free; make room or use --to"
  fi
}

# Fetches URL to FILE, from where an earlier download stopped.
download() {
  local url=$1 file=$2 length have=0 code=0
  if [[ -e $file.part ]]; then have=$(stat -c %s "$file.part"); fi
  length=$(curl --silent --location --head --fail --max-time 60 "$url" 2>/dev/null |
    tr -d '\r' | awk 'tolower($1) == "content-length:" { n = $2 } END { print n + 0 }') || length=0
  if ((length > have)); then need_room $((length - have)) "${file##*/}"; fi
  if ((length == 0 || length != have)); then
    curl --location --fail --continue-at - --retry 5 --retry-delay 2 --connect-timeout 30 --show-error --no-progress-meter \
      --output "$file.part" "$url" 2>"$file.error" || code=$?
  fi
  local said
  said=$(tail -n 1 "$file.error" 2>/dev/null || true)
  rm -f "$file.error"
  case $code in
    0) ;;
    23) fail "$file: cannot be written; make room or use --to" ;;
    *) fail "$url: ${said:-curl ends with exit code $code}; the same command goes on with the download" ;;
  esac
  mv "$file.part" "$file"
}

# FILE SUM RECORDED: what nobody has published is recorded once the archive was unpacked (to_record).
check_sum() {
  local file=$1 sum=$2 recorded=$3 found
  found=$(sha256sum "$file")
  found=${found%% *}
  if [[ $sum == - && -e $recorded ]]; then read -r sum _ <"$recorded"; fi
  if [[ $sum == - ]]; then
    to_record+=("$recorded" "$found  ${file##*/}")
  elif [[ $sum != "$found" ]]; then
    mv "$file" "$file.wrong"
    local says=
    if [[ -e $recorded ]]; then says=" ($recorded)"; fi
    fail "${file##*/}: has sha256 $found, expected $sum$says; it is now $file.wrong, run the same command to fetch it again"
  fi
}

# Takes the scenes out of the archives: unpack NAME ARCHIVE... with the folder and the scenes in the environment.
unpack() {
  python3 - "$@" <<'PYTHON'
import json
import os
import re
import shutil
import sys
import zipfile
import zlib
from pathlib import Path


def fail(text):
    sys.exit(f"scripts/datasets.sh: {text}")


def need_room(folder, size, what):
    free = shutil.disk_usage(folder).free
    if free < size:
        fail(f"{folder}: {what} needs {size // 1000000 + 1} MB and {free // 1000000} MB are free; make room or use --to")


def copy(archive, member, target):
    target.parent.mkdir(parents=True, exist_ok=True)
    with archive.open(member) as source, open(target, "wb") as to:
        shutil.copyfileobj(source, to, 1 << 20)


def folders(archive, scene):
    """Files of a folder of this name at the top or up to three below, by their path in it."""
    files = {}
    for member in archive.infolist():
        parts = member.filename.split("/")
        if parts[0] == "__MACOSX" or member.is_dir() or ".." in parts:
            continue
        if scene in parts[:-1][:4]:
            files["/".join(parts[parts.index(scene) + 1:])] = member
    return files


def camera(text):
    """K and the camera-to-world matrix (OpenGL axes) of a projection matrix of DTU."""
    p = [[float(x) for x in line.split()] for line in text.strip().splitlines()[:3]]
    dot = lambda a, b: sum(x * y for x, y in zip(a, b))
    cross = lambda a, b: [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    if dot(p[0][:3], cross(p[1][:3], p[2][:3])) < 0:
        p = [[-x for x in row] for row in p]
    m1, m2, m3 = (row[:3] for row in p)
    k33 = dot(m3, m3) ** 0.5
    r3 = [x / k33 for x in m3]
    k23 = dot(m2, r3)
    rest = [x - k23 * y for x, y in zip(m2, r3)]
    k22 = dot(rest, rest) ** 0.5
    r2 = [x / k22 for x in rest]
    r1 = cross(r2, r3)
    k11, k13 = dot(m1, r1), dot(m1, r3)
    # M center = -p4
    determinant, q = dot(m1, cross(m2, m3)), [-row[3] for row in p]
    columns = [cross(m2, m3), cross(m3, m1), cross(m1, m2)]
    center = [sum(q[i] * columns[i][j] for i in range(3)) / determinant for j in range(3)]
    matrix = [[r1[i], -r2[i], -r3[i], center[i]] for i in range(3)] + [[0.0, 0.0, 0.0, 1.0]]
    return {"fl_x": k11 / k33, "fl_y": k22 / k33, "cx": k13 / k33, "cy": k23 / k33, "w": 1600, "h": 1200}, matrix


def dtu_scene(archives, scene, folder):
    """49 photos under the light that sparse-view papers use, and their cameras."""
    cameras = {}
    for member in archives[0].namelist():
        found = re.search(r"Calibration/cal18/pos_(\d+)\.txt$", member)
        if found:
            cameras[int(found[1])] = archives[0].read(member).decode()
    frames = []
    photos = {}
    for name, member in folders(archives[1], scene).items():
        found = re.fullmatch(r"rect_(\d+)_3_r5000\.png", name)
        if found and int(found[1]) <= 49:
            photos[int(found[1])] = member
    if len(photos) != 49 or any(n not in cameras for n in photos):
        fail(f"{scene}: {len(photos)} of 49 photos and {len(cameras)} cameras are in the archives; they are not what was expected")
    need_room(folder.parent, sum(member.file_size for member in photos.values()), scene)
    for number, member in sorted(photos.items()):
        name = f"images/rect_{number:03d}_3_r5000.png"
        copy(archives[1], member, folder / name)
        intrinsics, matrix = camera(cameras[number])
        frames.append({"file_path": name, **intrinsics, "transform_matrix": matrix})
    (folder / "transforms.json").write_text(json.dumps({"camera_model": "PINHOLE", "frames": frames}, indent=1) + "\n")


def main():
    name, *paths = sys.argv[1:]
    to = Path(os.environ["DATASETS_TO"]) / name
    archives = []
    for path in paths:
        try:
            archives.append(zipfile.ZipFile(path))
        except zipfile.BadZipFile:
            fail(f"{path}: is no zip archive; remove it and run the same command again")
    for scene in os.environ["DATASETS_SCENES"].split():
        part = to / f".{scene}.part"
        shutil.rmtree(part, ignore_errors=True)
        part.mkdir(parents=True)
        try:
            if name == "dtu":
                dtu_scene(archives, scene, part)
            else:
                files = folders(archives[0], scene)
                if not files:
                    fail(f"{scene}: is not in {paths[0]}; it is not what was expected")
                need_room(to, sum(member.file_size for member in files.values()), scene)
                for path, member in files.items():
                    copy(archives[0], member, part / path)
        except (zipfile.BadZipFile, zlib.error, EOFError) as error:
            fail(f"{' or '.join(paths)}: is damaged ({error}); remove it and run the same command again")
        except OSError as error:
            fail(f"{part}: {error.strerror or error}; make room or use --to")
        part.rename(to / scene)
        print(f"{to / scene}")


main()
PYTHON
}

mkdir -p "$to/.archives" 2>/dev/null || fail "$to: cannot be made or written; use --to"
for name in "${names[@]}"; do
  scenes=
  for scene in ${wanted:-$(scenes_of "$name")}; do
    [[ " $(scenes_of "$name") " == *" $scene "* ]] || fail "$name has no scene '$scene'; it has $(scenes_of "$name")" 2
    [[ -d $to/$name/$scene ]] || scenes+="$scene "
  done
  if [[ -z $scenes ]]; then
    echo "$to/$name: is there"
    continue
  fi
  mkdir -p "$to/$name"
  files=() to_record=()
  while read -r archive url sum; do
    if [[ -n $from ]]; then url=${from%/}/$archive; fi
    file=$to/.archives/$archive
    if [[ ! -e $file ]]; then
      echo "fetching $url"
      download "$url" "$file"
    fi
    check_sum "$file" "$sum" "$to/$name/$archive.sha256"
    files+=("$file")
  done < <(archives_of "$name")
  DATASETS_TO=$to DATASETS_SCENES=$scenes unpack "$name" "${files[@]}" || exit 4
  for ((i = 0; i < ${#to_record[@]}; i += 2)); do
    echo "${to_record[i + 1]}" >"${to_record[i]}"
    echo "sha256 ${to_record[i + 1]}: written to ${to_record[i]}; nobody has published it"
  done
  if ((!keep)); then rm -f "${files[@]}"; fi
done
rmdir "$to/.archives" 2>/dev/null || true
