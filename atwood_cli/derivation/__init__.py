"""The equations of a scene, written out with the numbers put in."""
