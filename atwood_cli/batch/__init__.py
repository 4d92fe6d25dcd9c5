"""Files of scenes: a table in, the same table with its results out."""
