#!/usr/bin/env bash
# Makes the README's images and a 10-second film from one scene, by the program alone.
#   scripts/make_gallery.sh SCENE [IMAGES]      default for IMAGES: docs/images
# Writes NAME_plain.jpg, NAME_oraclegs.jpg and NAME_truth.jpg (a test view without proposals, with them, and as it is),
# NAME_proposal.jpg and NAME_confidence.jpg, and NAME_flight.webp (color, depth and support along an orbit, below
# 2.5 MB). NAME is that of the scene's folder. Work is kept in build/gallery/NAME and not done twice.
# Environment: RUN_OPTIONS (of the runs), TEST_VIEW and PROPOSAL (names without extension; default: the test view that
# gains most, the first proposal).
set -euo pipefail
here=$(cd "$(dirname "$0")/.." && pwd)
if (($# < 1 || $# > 2)); then
  sed -n '2,8s/^# \{0,1\}//p' "$0" >&2
  exit 2
fi
scene=$(realpath "$1")
images=$(realpath -m "${2:-$here/docs/images}")
name=$(basename "$scene")
work=$here/build/gallery/$name
program=${ORACLEGS_BIN:-$here/build/release/bin/oraclegs}
read -ra options <<<"${RUN_OPTIONS:---eval --views 12 --downscale 2 --iterations 7000 --max-gaussians 100000}"
for tool in ffmpeg python3 "$program"; do
  command -v "$tool" >/dev/null || { echo "scripts/make_gallery.sh: $tool is not there" >&2; exit 1; }
done
mkdir -p "$images" "$work"

"$program" reconstruct "$scene" -o "$work/run" "${options[@]}"
"$program" reconstruct "$scene" -o "$work/plain" "${options[@]}" --proposers none

test_view=${TEST_VIEW:-$(python3 - "$work/run/metrics.json" "$work/plain/metrics.json" <<'PYTHON'
import json, sys
ours, plain = ({v["name"]: v["psnr"] for v in json.load(open(path))["test"]["views"]} for path in sys.argv[1:])
print(max(ours, key=lambda name: ours[name] - plain[name]).replace("/", "_").rsplit(".", 1)[0])
PYTHON
)}
jpeg() { ffmpeg -y -loglevel error -i "$1" -q:v 3 "$2"; }
jpeg "$work/plain/renders/test/$test_view.png" "$images/${name}_plain.jpg"
jpeg "$work/run/renders/test/$test_view.png" "$images/${name}_oraclegs.jpg"
jpeg "$work/run/renders/test/${test_view}_gt.png" "$images/${name}_truth.jpg"

# A preview is a proposal with its confidence at its right.
preview=$(find "$work/run/confidence/preview" -name "${PROPOSAL:-*}.png" 2>/dev/null | sort | head -1 || true)
if [[ -n $preview ]]; then
  ffmpeg -y -loglevel error -i "$preview" -vf "crop=iw/2:ih:0:0" -q:v 3 "$images/${name}_proposal.jpg"
  ffmpeg -y -loglevel error -i "$preview" -vf "crop=iw/2:ih:iw/2:0" -q:v 3 "$images/${name}_confidence.jpg"
fi

frames=120 # 10 seconds
"$program" render "$work/run" --path orbit --frames $frames --what color,depth,support --no-video -o "$work/flight"
for quality in 60 45 30 20 10; do
  ffmpeg -y -loglevel error -framerate 12 -i "$work/flight/%04d.png" -framerate 12 -i "$work/flight/depth/%04d.png" \
    -framerate 12 -i "$work/flight/support/%04d.png" \
    -filter_complex "hstack=3,scale=720:-2" -c:v libwebp_anim -loop 0 -q:v $quality "$work/flight.webp"
  (($(stat -c %s "$work/flight.webp") < 2500000)) && break
done
cp "$work/flight.webp" "$images/${name}_flight.webp"
ls -l "$images/${name}"_*
