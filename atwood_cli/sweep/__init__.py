"""Scenes along a range or a list: `atwood sweep`."""
