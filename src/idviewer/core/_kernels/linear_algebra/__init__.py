"""Compiled sparse and tall-skinny linear algebra."""
