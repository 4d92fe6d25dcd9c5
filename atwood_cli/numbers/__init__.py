"""The numbers that equations run in, and their digits: fractions, intervals of decimals, formulas."""
