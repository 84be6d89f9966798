"""Jointed rock masses with plane waves, as pure functions of arrays; stress tension positive."""
