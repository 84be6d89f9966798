"""A jointed elastic body as a dolfinx model, in one, two or three dimensions."""
