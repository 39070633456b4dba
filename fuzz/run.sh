#!/usr/bin/env bash
# Runs every target for SECONDS each, on JOBS processes that share a corpus, all targets at once.
#
#   run.sh SECONDS [JOBS] [FOLDER]
#
# FOLDER holds `bin/`, `seeds/` and `dictionaries/`; it is that of this script unless given, and takes `corpus/`,
# `crashes/` and `logs/`. `bin.tar.gz` and `corpus.tar.gz` are unpacked where the folder is not there. No Rust is
# needed: the binaries are made by `build.sh`. Exits with 1 if anything was found.
set -u
seconds=${1:?how many seconds for each target}
jobs=${2:-1}
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "${3:-$here}" && pwd)
for part in bin corpus; do
  [ -d "$root/$part" ] || [ ! -f "$root/$part.tar.gz" ] || tar xzf "$root/$part.tar.gz" -C "$root" || exit 2
done
# Longer inputs say the same more slowly.
longest=8192
export ASAN_OPTIONS=allocator_may_return_null=1:detect_leaks=0:abort_on_error=0:symbolize=0
mkdir -p "$root/crashes" "$root/logs" "$root/corpus"
# Inputs are read from files: on a disk in memory where there is one.
if [ -d /dev/shm ]; then PHOTON_FUZZ_FOLDER=$(mktemp -d -p /dev/shm); else PHOTON_FUZZ_FOLDER=$(mktemp -d); fi
export PHOTON_FUZZ_FOLDER
trap 'rm -rf "$PHOTON_FUZZ_FOLDER"' EXIT

one() { # target, number of the process
  local target=$1 number=$2 left=$seconds part=0 start dictionary=()
  [ -f "$root/dictionaries/$target.dict" ] && dictionary=(-dict="$root/dictionaries/$target.dict")
  # libFuzzer ends at what it finds: it is begun anew until its time is up.
  while [ "$left" -gt 0 ]; do
    start=$(date +%s)
    "$root/bin/$target" -max_total_time="$left" -timeout=10 -rss_limit_mb=2048 -malloc_limit_mb=512 \
      -max_len=$longest -print_final_stats=1 -reload=10 -artifact_prefix="$root/crashes/$target-" "${dictionary[@]}" \
      "$root/corpus/$target" "$root/seeds/$target" > "$root/logs/$target-$number-$part.log" 2>&1
    # What is found in the corpus would end every run that begins with it.
    for finding in "$root/crashes/$target"-*; do rm -f "$root/corpus/$target/${finding##*-}"; done
    left=$((left - ($(date +%s) - start)))
    part=$((part + 1))
    [ "$part" -ge 50 ] && break
  done
}

for binary in "$root"/bin/*; do
  target=$(basename "$binary")
  mkdir -p "$root/corpus/$target"
  rm -f "$root/logs/$target"-*.log
  for number in $(seq "$jobs"); do one "$target" "$number" & done
done
wait

printf '%-10s %12s %8s %9s %8s %8s\n' target execs seconds coverage corpus findings
found=0
for binary in "$root"/bin/*; do
  target=$(basename "$binary")
  execs=$(cat "$root/logs/$target"-*.log | awk '/stat::number_of_executed_units/ {n += $2} END {print n + 0}')
  coverage=$(cat "$root/logs/$target"-*.log | grep -o 'cov: [0-9]*' | awk '{if ($2 > m) m = $2} END {print m + 0}')
  corpus=$(find "$root/corpus/$target" -type f | wc -l)
  findings=$(find "$root/crashes" -type f -name "$target-*" | wc -l)
  found=$((found + findings))
  printf '%-10s %12s %8s %9s %8s %8s\n' "$target" "$execs" $((seconds * jobs)) "$coverage" "$corpus" "$findings"
done
[ "$found" -eq 0 ]
