#!/bin/sh
# A check for CI: status 1, and a line on stderr for each condition that does not hold.
set -eu
atwood solve --m1 1 --m2 3 --M 10 --mu 0.3 --only regime \
    --expect no-slip --expect 'safety_factor >= 1.4' --expect 'a < 0.3g'
