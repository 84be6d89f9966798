"""The joint laws, shared by both engines."""
