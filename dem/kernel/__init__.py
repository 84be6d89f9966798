"""The compiled step of rigid blocks, its constants and its state."""
