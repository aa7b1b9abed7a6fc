#!/bin/sh
# What `cmake --install` leaves must be enough to build the C example, by find_package and by pkg-config, from where
# it was moved to; and the example must cull by a control_view of this test's own.
# usage: installed_tree.sh BUILD_FOLDER SOURCE_FOLDER LIBRARY_FOLDER SCRATCH_FOLDER CONTROL_VIEW
set -eu
build=$1 source=$2 library=$3 scratch=$4 control_view=$5
rm -rf "$scratch"
mkdir -p "$scratch"
for component in library development; do
  cmake --install "$build" --prefix "$scratch/first" --component $component >"$scratch/install.log"
done
mv "$scratch/first" "$scratch/installed"
tree=$scratch/installed

"$control_view" --bind 'tcp://127.0.0.1:*' --announce "$scratch/endpoint" --die-with-parent --log error >/dev/null &
daemon=$!
trap 'kill $daemon' EXIT
waited=0
until [ -s "$scratch/endpoint" ]; do
  waited=$((waited + 1))
  [ $waited -lt 200 ] || { echo "control_view does not listen" && exit 1; }
  sleep 0.05
done
endpoint=$(cat "$scratch/endpoint")

# Of 1600 houses some 600 are in view, and a few dozen can be seen: the frames after the first few must know.
expect_culling() {
  "$@" "$endpoint" 90 | tee "$scratch/output"
  drawn=$(sed -n 's/.* \([0-9]*\)\.[0-9]* of 1600 houses drawn a frame/\1/p' "$scratch/output")
  [ "$drawn" -ge 10 ] && [ "$drawn" -le 400 ]
}

example=$source/examples/c
[ -e "$tree/include/sightline.h" ]
[ -e "$tree/share/man/man3/libsightline.3" ]

cmake -S "$example" -B "$scratch/by_cmake" -G Ninja -Dsightline_ROOT="$tree" >"$scratch/configure.log"
cmake --build "$scratch/by_cmake" >"$scratch/build.log"
expect_culling "$scratch/by_cmake/cull_scene"
ldd "$scratch/by_cmake/cull_scene" | grep -q "libsightline.so.1 => $tree"

export PKG_CONFIG_PATH=$tree/$library/pkgconfig
[ "$(pkg-config --modversion sightline | cut -d. -f1)" = 1 ]
# shellcheck disable=SC2046
cc -std=c99 -pedantic -Wall -Wextra -Werror -o "$scratch/by_pkg_config" "$example/cull_scene.c" "$example/town.c" \
  $(pkg-config --cflags --libs sightline) -lm
expect_culling env LD_LIBRARY_PATH="$tree/$library" "$scratch/by_pkg_config"
