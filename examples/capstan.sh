#!/bin/sh
# A capstan: how much a rope holds for each kg that holds its free end.
# Published: a factor of 153,552,935 for 5 turns at mu = 0.6 (Wikipedia, "Capstan equation").
set -eu

echo "5 turns at mu = 0.6:"
atwood solve --m1 1 --m2 2 --mu 0.6 --wrap 5turn --only least_heavier_mass --digits 9

echo "turns, and what 1 kg holds at mu = 0.3:"
for turns in 0.5 1 2 3; do
    echo "$turns $(atwood solve --m1 1 --m2 2 --mu 0.3 --wrap ${turns}turn --only least_heavier_mass --digits 3) kg"
done

echo "Coulomb friction at its limit, seen by 1000 elements of string, beside the exact ratio:"
atwood contact --m1 1 --m2 1000 --M inf --mu 0.3 --wrap 3turn --elements 1000 --digits 8 --csv
