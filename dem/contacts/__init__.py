"""Contacts of rigid blocks: their faces, law, layout in chunks, and the critical step."""
