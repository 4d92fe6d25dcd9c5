"""The number types the equations run in, and how one rounded result is settled."""
