"""Loads and boundary conditions of a body: forces, absorbing and held sides."""
