"""Bars of deformable rock, homogenised or with every joint resolved."""
