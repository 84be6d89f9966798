"""Criteria of the robustness suite."""
