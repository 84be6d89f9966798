"""Closed forms that the tests hold the engines against, beside those of `compare.exact`."""
