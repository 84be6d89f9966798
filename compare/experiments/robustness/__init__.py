"""The robustness suite: hard cases, each with a criterion from theory."""
