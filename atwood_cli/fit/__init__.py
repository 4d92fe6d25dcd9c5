"""Runs of a laboratory: what of the pulley and its axle they require, by least squares."""
