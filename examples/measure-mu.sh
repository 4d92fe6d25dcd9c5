#!/bin/sh
# Measuring friction: a string over a rod that is clamped, so --M inf, and weight added on one side until
# the string slips. mu_verge is then the coefficient of static friction, ln(m2/m1) over the angle of wrap.
set -eu

echo "slipped at 152 g against 50 g, over half a turn known to 3 degrees:"
atwood solve --m1 '50.0(1)g' --m2 '152(1)g' --M inf --wrap '180(3)' --csv --only mu_verge

echo "which of them to measure better, in percent of the variance:"
atwood solve --m1 '50.0(1)g' --m2 '152(1)g' --M inf --wrap '180(3)' --budget --json --only mu_verge

echo "the same string with another turn around the rod, where the angle matters less:"
atwood solve --m1 '50.0(1)g' --m2 '1.38(1)kg' --M inf --wrap '540(3)' --csv --only mu_verge | tail -1
