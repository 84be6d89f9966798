"""Rigid blocks of any convex shape in the plane: three freedoms a block, joints between edges."""
