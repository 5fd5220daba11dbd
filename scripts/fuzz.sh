#!/usr/bin/env bash
# Runs the fuzzers of the parsers from their committed corpus, two at once, and prints a table. Exit code 1, and the name of
# the file that reproduces it, where one finds something. Needs clang (scripts/bootstrap.sh).
#   scripts/fuzz.sh                    every target, 20 seconds each
#   scripts/fuzz.sh png gltf           these targets
#   scripts/fuzz.sh --seconds 300      longer; --hours 8 divides the time over the targets; --seed 1 repeats the inputs
#   scripts/fuzz.sh --coverage         lines of the parsers that the corpus reaches, and the rest
#   scripts/fuzz.sh --merge            adds to the corpus what was found and reaches new code
#   scripts/fuzz.sh --pack ply         writes tests/fuzz/corpus/ply.zip from build/asan/fuzz_corpus/ply
# What is found is kept in build/fuzz/ and is where the next run goes on.
set -euo pipefail
cd "$(dirname "$0")/.."

seconds=20 seed=0 hours='' mode=run targets=()
while (($# > 0)); do
  case $1 in
    --seconds) seconds=$2; shift ;;
    --seed) seed=$2; shift ;;
    --hours) hours=$2; shift ;;
    --coverage | --merge | --pack) mode=${1#--} ;;
    -*) sed -n '2,10s/^# \?//p' "$0" >&2; exit 2 ;;
    *) targets+=("$1") ;;
  esac
  shift
done

corpus=build/asan/fuzz_corpus work=build/fuzz bin=build/asan/bin/fuzz
jobs=2
((${#targets[@]} > 0)) || mapfile -t targets < <(ls tests/fuzz | sed -n 's/_fuzz\.cpp$//p')
for target in "${targets[@]}"; do
  [[ -f tests/fuzz/${target}_fuzz.cpp ]] || { echo "scripts/fuzz.sh: there is no target $target" >&2; exit 2; }
done

# Most bytes of an input: parsers of text and headers need few, and small inputs are fast.
max_len() {
  case $1 in
    ply | sog | gltf | usd | heif | photo | config | workspace | train_checkpoint | database) echo 16384 ;;
    *) echo 4096 ;;
  esac
}

# Seconds that an input may take. Those that go through sockets, load certificates, or decode with programs of others that
# are not made for speed with sanitizers, may wait for a core.
time_limit() {
  case $1 in
    download | web_server | heif | photo) echo 5 ;;
    *) echo 1 ;;
  esac
}

# The lines of the parsers that the corpus reaches, by clang's coverage of sources.
coverage() {
  local build=build/fuzz-coverage
  cmake --preset asan -B $build -DORACLEGS_SANITIZE= -DORACLEGS_FUZZ=OFF -DCMAKE_BUILD_TYPE=Debug -DORACLEGS_PYTHON=OFF \
    -DCMAKE_CXX_FLAGS='-fprofile-instr-generate -fcoverage-mapping' >/dev/null
  cmake --build $build --parallel $jobs --target fuzz_replay
  LLVM_PROFILE_FILE=$build/replay.profraw $build/bin/fuzz_replay $build/fuzz_corpus
  local llvm; llvm=$(dirname "$(readlink -f "$(command -v clang++)")")
  "$llvm/llvm-profdata" merge -sparse $build/replay.profraw -o $build/replay.profdata
  local sources; mapfile -t sources < <(sed '/^#/d; s/ .*//' tests/fuzz/parsers.txt)
  local objects=($build/bin/fuzz_replay -object $build/lib/liboraclegs_core.so)
  "$llvm/llvm-cov" export -format=lcov -instr-profile $build/replay.profdata "${objects[@]}" "${sources[@]}" >$build/lines.txt
  python3 tests/fuzz/coverage.py $build/lines.txt tests/fuzz/parsers.txt
}

# The same bytes for the same files.
pack() {
  python3 - "$corpus/$1" "tests/fuzz/corpus/$1.zip" <<'PACK'
import pathlib, sys, zipfile
with zipfile.ZipFile(sys.argv[2], "w") as archive:
    for path in sorted(pathlib.Path(sys.argv[1]).iterdir()):
        archive.writestr(zipfile.ZipInfo(path.name), path.read_bytes(), zipfile.ZIP_DEFLATED, 9)
PACK
}

build() {
  cmake --preset asan >/dev/null
  cmake --build --preset asan --parallel $jobs --target "${targets[@]/%/_fuzz}"
}

options_of() {
  options=(-rss_limit_mb=1024 -max_len="$(max_len "$1")" -timeout="$(time_limit "$1")")
  [[ ! -f tests/fuzz/dictionaries/$1.dict ]] || options+=(-dict="tests/fuzz/dictionaries/$1.dict")
}

export ASAN_OPTIONS=${ASAN_OPTIONS:-abort_on_error=0:detect_leaks=1}
export LSAN_OPTIONS=${LSAN_OPTIONS:-suppressions=tests/support/leaks_of_others.txt:print_suppressions=0}
TMPDIR=$(mktemp -d -p /dev/shm oraclegs-fuzz-XXXXXX)
export TMPDIR
trap 'rm -rf "$TMPDIR"' EXIT

# A timeout that does not come again was another process that took the core.
confirmed() {
  local file=$1 target=$2 try
  [[ ${file##*/} == "$target-timeout-"* || ${file##*/} == "$target-slow-unit-"* ]] || return 0
  for try in 1 2 3; do
    if "$bin/${target}_fuzz" -timeout="$(time_limit "$target")" -rss_limit_mb=1024 "$file" >/dev/null 2>&1; then
      rm "$file"
      return 1
    fi
  done
}

# Until the time is over, or something is found: what was only slow because another process took the core is not.
fuzz() {
  local target=$1 end=$((SECONDS + seconds)) file
  options_of "$target"
  mkdir -p "$work/corpus/$target"
  : >"$work/$target.log"
  while ((SECONDS < end)); do
    "$bin/${target}_fuzz" "${options[@]}" -seed="$seed" -max_total_time=$((end - SECONDS)) -print_final_stats=1 \
      -artifact_prefix="$work/found/$target-" "$work/corpus/$target" "$corpus/$target" >>"$work/$target.log" 2>&1 && break
    for file in "$work/found/$target"-*; do
      if [[ ! -e $file ]] || confirmed "$file" "$target"; then return; fi
    done
  done
}

case $mode in
  coverage) coverage; exit ;;
  pack) for target in "${targets[@]}"; do pack "$target"; done; exit ;;
  merge)
    build
    for target in "${targets[@]}"; do
      options_of "$target"
      # What is there stays. Of what was found come small files that reach a branch for the first time, however often.
      mkdir -p "$TMPDIR/$target" "$work/corpus/$target"
      find "$work/corpus/$target" -type f -size -5k -exec cp -t "$TMPDIR/$target" {} +
      "$bin/${target}_fuzz" "${options[@]}" -set_cover_merge=1 -use_counters=0 "$corpus/$target" "$TMPDIR/$target" >/dev/null 2>&1
      pack "$target"
      echo "$target: $(find "$corpus/$target" -type f | wc -l) files, $(du -sk --apparent-size "$corpus/$target" | cut -f1) kB"
    done
    exit
    ;;
esac

build
[[ -z $hours ]] || seconds=$(awk "BEGIN { print int($hours * 3600 * $jobs / ${#targets[@]}) }")
mkdir -p "$work/found"
rm -f "$work"/found/*
running=0
for target in "${targets[@]}"; do
  if ((running == jobs)); then
    wait -n || true
    running=$((running - 1))
  fi
  fuzz "$target" &
  running=$((running + 1))
done
wait

# Of all its runs: the sum of what is counted, the largest of what is measured.
stat() {
  awk -v of="$2" '$1 == "stat::" of ":" { sum += $2; if ($2 > most) most = $2 }
                  END { print of == "number_of_executed_units" ? sum + 0 : most + 0 }' "$work/$1.log"
}
total=0 bad=0
printf '%-18s %12s %9s %9s  %s\n' target executions exec/s 'peak MB' findings
for target in "${targets[@]}"; do
  runs=$(stat "$target" number_of_executed_units) found=()
  for file in "$work/found/$target"-*; do
    if [[ -e $file ]]; then found+=("$file"); fi
  done
  if ((runs == 0)); then found+=("$work/$target.log"); fi
  printf '%-18s %12s %9s %9s  %s\n' "$target" "$runs" "$(stat "$target" average_exec_per_sec)" \
    "$(stat "$target" peak_rss_mb)" "${found[*]:-0}"
  total=$((total + runs)) bad=$((bad + ${#found[@]}))
done
printf '%-18s %12s %19s  %s\n' total "$total" '' "$bad"
((bad == 0))
