#!/bin/sh
# The inertia of a pulley from measured accelerations: eight runs of a public student lab report, with
# g = 9.81 m/s^2. --a finds the pulley; as a hoop, its mass is c = I/R^2, its inertia as a mass at the rim.
# The accelerations are given to 0.001 m/s^2, so to +/-0.0003 as a standard uncertainty (0.0005/sqrt(3)).
set -eu

runs='0.055 0.060 0.380
0.060 0.065 0.354
0.065 0.070 0.323
0.070 0.075 0.310
0.075 0.080 0.303
0.080 0.085 0.279
0.065 0.075 0.649
0.080 0.095 0.780'

echo "m1 (kg)  m2 (kg)  a (m/s^2)  c (g)"
echo "$runs" | while read -r m1 m2 a; do
    mass=$(atwood solve --m1 $m1 --m2 $m2 --a "$a+/-0.0003" --g 9.81 --inertia hoop \
        --csv --only pulley_mass | tail -1)
    echo "$m1 $m2 $a $mass" | tr , ' ' |
        awk '{ printf "%s    %s    %s      %.1f +/- %.1f\n", $1, $2, $3, 1000 * $4, 1000 * $5 }'
done

echo "All runs at once, by least squares: (m2 - m1) g = a (m1 + m2 + c) + f, f from friction in the axle."
echo "$runs" | python3 -c '
import sys
from math import sqrt

runs = [tuple(map(float, line.split())) for line in sys.stdin]
x = [a for _, _, a in runs]
y = [(m2 - m1) * 9.81 - a * (m1 + m2) for m1, m2, a in runs]
n, mean_x, mean_y = len(runs), sum(x) / len(runs), sum(y) / len(runs)
spread = sum((a - mean_x) ** 2 for a in x)
c = sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)) / spread
f = mean_y - c * mean_x
scatter = sum((b - c * a - f) ** 2 for a, b in zip(x, y)) / (n - 2)
u_c, u_f = sqrt(scatter / spread), sqrt(scatter * (1 / n + mean_x**2 / spread))
print(f"c = {1000 * c:.1f} +/- {1000 * u_c:.1f} g, f = {1000 * f:.1f} +/- {1000 * u_f:.1f} mN")
'

echo "1 % in a is 1 % of all that moves, m1 + m2 + c: light masses show the pulley best."
for m1 in 0.010 0.080; do
    a=$(atwood solve --m1 $m1 --m2 0.090 --M 13g --inertia hoop --g 9.81 --only acceleration --digits 4)
    u=$(echo "$a" | awk '{ print $1 / 100 }')
    atwood solve --m1 $m1 --m2 0.090 --a "$a+/-$u" --g 9.81 --inertia hoop --csv --only pulley_mass |
        awk -F, -v m1="$m1" 'NR > 1 { printf "m1 = %s kg: c = %.1f +/- %.1f g\n", m1, 1000 * $1, 1000 * $2 }'
done
