"""Convex rigid blocks in the plane: three degrees of freedom per block, joints between edges."""
