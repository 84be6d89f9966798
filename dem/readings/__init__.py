"""Readings of rigid blocks: waveforms, sections, snapshots."""
