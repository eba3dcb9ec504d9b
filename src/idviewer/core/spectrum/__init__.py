"""Spectrum: Laplacians of boundaries and their eigenpairs."""
