"""What is read of blocks: waveforms, sections, snapshots."""
