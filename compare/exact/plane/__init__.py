"""Jointed rock masses in plane strain: pure functions of arrays, stress tension positive."""
