"""Loads and boundary conditions of a body: forces, absorbing, fixed and roller sides."""
