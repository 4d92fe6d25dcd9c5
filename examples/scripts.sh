#!/bin/sh
# Ways to use atwood in scripts.
set -eu

# One value in a variable.
a=$(atwood solve --m1 250g --m2 300g --M 120g --only acceleration --digits 4)
echo "acceleration: $a m/s^2"

# A decision: what does the string do?
for M in 10 40 50; do
    echo "pulley of $M kg: $(atwood solve --m1 1 --m2 3 --mu 0.3 --M $M --only regime)"
done

# A value that the scene does not determine: nothing on stdout, the reason on stderr, status 1.
atwood solve --m1 1 --m2 3 --only torque 2>&1 || echo "status $?"

# A table of scenes: one header, a row each.
for mu in 0.1 0.2 0.3; do
    atwood solve --m1 1 --m2 3 --mu $mu --digits 5 --csv --only mu_verge --only critical_pulley_mass
done | awk 'NR == 1 || !/mu_verge/'

# JSON for other programs.
atwood solve --m1 1 --m2 3 --M 100 --mu 0.3 --json | python3 -c '
import json, sys
result = json.load(sys.stdin)
print(result["regime"], result["acceleration"], result["scene"]["M"])'
