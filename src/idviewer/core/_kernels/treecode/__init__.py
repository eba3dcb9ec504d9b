"""Compiled loops of the treecode: moments, expansions, traversal."""
