#!/usr/bin/env bash
# Builds every target with libFuzzer's instrumentation and the address sanitizer, and puts what `run.sh` needs into
# FOLDER, stripped: it runs on any machine with the same C library or a later one.
#
#   build.sh FOLDER
#
# Needs a nightly compiler, for the sanitizer. `cargo fuzz` passes the same flags.
set -eu
folder=${1:?where to put the binaries}
cd "$(dirname "$0")"
mkdir -p "$folder/bin"
export RUSTFLAGS="-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
-Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table \
-Cllvm-args=-sanitizer-coverage-trace-compares --cfg fuzzing -Zsanitizer=address -Ccodegen-units=1 -Cdebug-assertions"
# Without a target, cargo would instrument build scripts as well.
host=$(rustc +nightly -vV | sed -n 's/^host: //p')
cargo +nightly build --release --locked --bins --target "$host"
for source in fuzz_targets/*.rs; do
  target=$(basename "$source" .rs)
  strip -o "$folder/bin/$target" "target/$host/release/$target"
done
cp -r seeds dictionaries run.sh "$folder"
