"""The answers for one scene, to the digits asked for."""
