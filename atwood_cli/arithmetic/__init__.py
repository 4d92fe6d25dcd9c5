"""The number types the equations run in, and the rounding of their results to digits."""
