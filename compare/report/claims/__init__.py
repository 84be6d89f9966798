"""What Guo & Li (2002) claim, by the figures of the paper."""
