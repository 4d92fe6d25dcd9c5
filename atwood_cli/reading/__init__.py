"""What people type, read as exact inputs: numbers, units, names."""
