#!/usr/bin/env bash
# Runs the paper's presets from end to end at full size and measures each stage; --help says more (paper_rehearsal.py).
exec python3 "$(dirname "$0")/paper_rehearsal.py" "$@"
