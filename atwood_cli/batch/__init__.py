"""Tables of scenes: a table goes in, and comes out with its results."""
