#!/bin/sh
# The traction sheave of a lift at rest, its brake set, the car loaded with 125 % of its rated load: the
# loading condition of EN 81-50 (2014), 5.11.2, which takes mu = 0.1 there, times a factor for the groove.
# Car 900 kg, rated load 630 kg, counterweight 900 kg + 630 kg / 2. A guide sheave turns the ropes back
# to vertical, so that they touch the traction sheave over less than half a turn.
set -eu
car=1687.5 counterweight=1215

for wrap in 180 160 120; do
    echo "wrap $wrap: needs mu $(atwood solve --m1 $counterweight --m2 $car --M inf --wrap $wrap --only mu_verge --digits 3)," \
        "$(atwood solve --m1 $counterweight --m2 $car --M inf --wrap $wrap --mu 0.15 --only regime) at 0.15"
done

echo "the car that would slip over 160 degrees at 0.15:"
atwood solve --m1 $counterweight --m2 $car --M inf --wrap 160 --mu 0.15 --only critical_heavier_mass --digits 5

echo "its safety factor, mu over the least mu that holds:"
atwood solve --m1 $counterweight --m2 $car --M inf --wrap 160 --mu 0.15 --only safety_factor --digits 4
