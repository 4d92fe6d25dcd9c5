"""What accuracy costs in time, measured."""
