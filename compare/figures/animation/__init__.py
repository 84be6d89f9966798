"""Animations and three-dimensional views of the pillars."""
