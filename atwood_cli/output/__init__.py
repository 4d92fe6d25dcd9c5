"""How results look: text, tables, type, pictures, and the files that they are written to."""
