"""Receivers of a body: points, joints, sections, snapshots."""
