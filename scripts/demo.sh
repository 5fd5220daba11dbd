#!/usr/bin/env bash
# Builds OracleGS with its Python package, renders a small scene with known truth and reconstructs it from 12 of its 24 images. Nothing is
# downloaded but Debian and npm packages. On two cores packages took three minutes, the build six, the scene two.
# The results go to build/demo, or to the folder given.
#   scripts/demo.sh [FOLDER]
set -euo pipefail
here=$(cd "$(dirname "$0")/.." && pwd)
folder=$(realpath -m "${1:-$here/build/demo}")
cd "$here"

scripts/bootstrap.sh
cmake --preset release >/dev/null
cmake --build --preset release --target oraclegs oraclegs_python --parallel "$(nproc)"

build/release/bin/oraclegs demo -o "$folder"

echo
echo "Side by side:         $folder/demo.png (a true image, and the same view of the splat)"
echo "Report:               $folder/run/report.html (open it in a browser: the splat in 3D, images, scores)"
echo "Input images:         $folder/scene/images"
echo "Test views, rendered: $folder/run/renders/test (NAME.png; NAME_gt.png is the true image)"
echo "Depth:                $folder/run/depth/preview"
echo "Scores:               $folder/run/metrics.json"
echo "Gaussian splat:       $folder/run/point_cloud.ply (opens in any 3DGS viewer)"
echo "In 3D, with cameras:  build/release/bin/oraclegs view $folder/run"
echo "Next: your own photos: build/release/bin/oraclegs reconstruct PHOTOS/ -o OUT/ (docs/tutorial.md)"
