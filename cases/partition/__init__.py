"""A rock mass in the plane: its domain cut by joint sets into convex polygonal blocks.

`cut` gives the `Partition`: blocks, contacts and boundary edges as plain arrays.
"""
