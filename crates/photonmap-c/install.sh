#!/bin/sh
# Installs the libraries, the header and the pkg-config file, after `cargo build --release -p photonmap-c`.
#
#     crates/photonmap-c/install.sh PREFIX [FOLDER]
#
# FOLDER has the built libraries: `release` in the target directory of cargo if it is not given.
set -eu
here=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd)
[ $# -ge 1 ] || { echo "usage: $0 PREFIX [FOLDER]" >&2; exit 2; }
built=${2:-${CARGO_TARGET_DIR:-$here/../../target}/release}
if [ ! -f "$built/libphotonmap_c.a" ]; then
  echo "$built: no libphotonmap_c.a; build it by: cargo build --release -p photonmap-c" >&2
  exit 1
fi
mkdir -p "$1/lib/pkgconfig" "$1/include"
prefix=$(CDPATH='' cd -- "$1" && pwd)
version=$(sed -n 's/^version = "\(.*\)"/\1/p' "$here/../../Cargo.toml" | head -n 1)

# In the build folder, `libphotonmap` is the Rust library of that name.
cp "$built/libphotonmap_c.a" "$prefix/lib/libphotonmap.a"
for ending in so dylib; do
  [ ! -f "$built/libphotonmap_c.$ending" ] || cp "$built/libphotonmap_c.$ending" "$prefix/lib/libphotonmap.$ending"
done
cp "$here/include/photonmap.h" "$prefix/include/"
sed -e "s|@PREFIX@|$prefix|" -e "s|@VERSION@|$version|" "$here/photonmap.pc.in" > "$prefix/lib/pkgconfig/photonmap.pc"
