#!/usr/bin/env bash
# Builds the fuzzers as OSS-Fuzz wants them: executables, seeds and dictionaries in $OUT. It gives CC, CXX, CFLAGS, CXXFLAGS,
# LIB_FUZZING_ENGINE, OUT and SRC; the packages of scripts/bootstrap.sh are there.
set -euo pipefail
source_dir=$(cd "$(dirname "$0")/../.." && pwd)
build=${WORK:-$OUT}/oraclegs-build
engine=${LIB_FUZZING_ENGINE:--fsanitize=fuzzer}

cmake -S "$source_dir" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_UNITY_BUILD=ON \
  -DCMAKE_C_COMPILER="${CC:-clang}" -DCMAKE_CXX_COMPILER="${CXX:-clang++}" -DCMAKE_CXX_FLAGS="${CXXFLAGS:-}" \
  -DCMAKE_BUILD_RPATH='$ORIGIN/lib' -DCMAKE_BUILD_RPATH_USE_ORIGIN=ON -DORACLEGS_FUZZ=ON -DORACLEGS_FUZZ_ENGINE="$engine" \
  -DORACLEGS_WERROR=OFF -DORACLEGS_NETWORKS=OFF -DORACLEGS_PYTHON=OFF -DORACLEGS_BENCH=OFF
cmake --build "$build" --parallel "$(nproc)" --target fuzzers

mkdir -p "$OUT/lib"
cp "$build"/lib/liboraclegs_core.so* "$OUT/lib/"
for fuzzer in "$build"/bin/fuzz/*_fuzz; do
  name=$(basename "$fuzzer")
  target=${name%_fuzz}
  cp "$fuzzer" "$OUT/"
  # The libraries of Debian that it is linked to, which the machine that runs it lacks.
  ldd "$fuzzer" | sed -n 's/.*=> \(\/[^ ]*\) .*/\1/p' | grep -v -e '/libc\.' -e '/libm\.' -e '/ld-' | xargs -r cp -nL -t "$OUT/lib/"
  cp "$source_dir/tests/fuzz/corpus/$target.zip" "$OUT/${name}_seed_corpus.zip"
  if [[ -f $source_dir/tests/fuzz/dictionaries/$target.dict ]]; then
    cp "$source_dir/tests/fuzz/dictionaries/$target.dict" "$OUT/$name.dict"
  fi
done
