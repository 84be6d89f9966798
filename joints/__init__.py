"""The joint laws: the one piece of physics that both engines share exactly."""
