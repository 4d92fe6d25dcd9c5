#!/bin/sh
# Ranges: where does the string begin to slip, and how does that depend on the friction?
set -eu

echo "the paper's masses on heavier and heavier pulleys:"
atwood sweep --m1 1 --m2 3 --mu 0.3 --M 0:50:6 --only regime --only acceleration --only mu_verge

echo "critical pulley mass by mu, for other programs:"
atwood sweep --m1 1 --m2 3 --mu 0.1:0.35:6 --only critical_pulley_mass --digits 5 --csv 2>&1

echo "what holds where (ratios of 10, by three coefficients):"
atwood sweep --m1 1 --m2 3 --M 1:1000:4:log --mu 0.2:0.4:3 --only regime --csv | grep -c no-slip

echo "a row again by itself:"
atwood sweep --m1 1 --m2 3 --M 0:1:4 --only acceleration --csv | sed -n 3p
atwood solve --m1 1 --m2 3 --M 0.333333 --only acceleration

echo "the curve, in a file that is there whole or not at all:"
folder=$(mktemp -d)
atwood sweep --m1 1 --m2 3 --mu 0.3 --M 1:100:100 --plot -o "$folder/curve.txt"
head -8 "$folder/curve.txt"
atwood sweep --m1 1 --m2 3 --mu 0.3 --M 1:100:100 -o "$folder/curve.txt" 2>/dev/null || echo "status $?"
rm -r "$folder"
