"""The robustness suite: hard cases, each held to a criterion from theory."""
