"""The law of a joint: the one piece of physics that both engines share exactly, a form a file."""
