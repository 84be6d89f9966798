"""What acts on a body: forces, absorbing and held sides."""
