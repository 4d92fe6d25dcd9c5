"""The solver: a scene of exact numbers in, every quantity out. It reads no text and writes no page."""
