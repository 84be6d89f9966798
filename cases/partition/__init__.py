"""The domain of a scene, cut by joint sets into convex blocks in any dimension."""
