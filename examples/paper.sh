#!/bin/sh
# The numbers of the paper: m1 = 1 kg, m2 = 3 kg, mu = 0.3 (its last section but one).
set -eu
solve() { atwood solve --m1 1 --mu 0.3 "$@"; }

echo "(34) critical pulley mass, about 43 kg:"
solve --m2 3 --only critical_pulley_mass --digits 2
solve --m2 3 --only critical_pulley_mass

echo "(4) acceleration and tensions at that mass:"
solve --m2 3 --only acceleration --only tension_1 --only tension_2 --digits 6

echo "(31), (32) friction force on the pulley, its x and y and its magnitude:"
solve --m2 3 --only friction_force_x --only friction_force_y --only friction_force --digits 6

echo "(20), (23) force on the axle, and torque for a radius of 10 cm:"
solve --m2 3 --R 10cm --only axle_force --only torque --digits 6

echo "(36) what the heavier mass and the pulley must exceed for the string to slip:"
solve --m2 3 --only least_heavier_mass --only least_pulley_mass --digits 6

echo "And back: (27) gives mu, (35) gives m2, from the critical mass to 30 digits:"
M=$(solve --m2 3 --only critical_pulley_mass --digits 30)
atwood solve --m1 1 --m2 3 --M "$M" --only mu_verge --digits 20
solve --m2 3 --M "$M" --only critical_heavier_mass --digits 20
