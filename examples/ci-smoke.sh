#!/bin/sh
# A smoke test for CI: fails unless atwood is there, right, and refuses nonsense.
set -eu

test "$(atwood solve --m1 1 --m2 3 --mu 0.3 --only critical_pulley_mass)" = 43.34192486321087
test "$(atwood solve --m1 1 --m2 3 --M 100 --mu 0.3 --only regime)" = slip

status=0
atwood solve --m1 1 --m2 -3 2>/dev/null || status=$?
test $status -eq 2

echo "atwood works"
