"""Claims of Guo & Li (2002), by the figures of their paper."""
