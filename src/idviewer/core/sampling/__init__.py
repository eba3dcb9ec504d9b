"""Sampling: the embedding at the points of slices, coarse to fine, within a tolerance."""
