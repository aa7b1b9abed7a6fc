#!/bin/sh
# The library shows what the header declares, with its version, and nothing else.
# usage: exported_symbols.sh LIBRARY HEADER
set -eu
shown=$(nm -D --defined-only --with-symbol-versions "$1" | awk '$2 != "A" { print $3 }' | sort)
declared=$(tr '\n' ' ' <"$2" | grep -o 'SL_API [^;]*;' | grep -o 'sl_[a-z_]*(' | tr -d '(' | sort -u)
expected=$(for name in $declared; do echo "$name@@SIGHTLINE_1.0"; done | sort)
[ "$shown" = "$expected" ] && exit 0
echo "shown but not declared (>), declared but not shown (<):"
printf '%s\n' "$shown" >/tmp/shown.$$
printf '%s\n' "$expected" | diff - /tmp/shown.$$ || true
rm -f /tmp/shown.$$
exit 1
