"""Spectrum: Laplacians of boundaries and their eigenpairs."""

from idviewer.core.spectrum.eigen_solver import SOLVER_VERSION, eigenpair_steps
from idviewer.core.spectrum.memory_estimate import check_room

__all__ = ["SOLVER_VERSION", "check_room", "eigenpair_steps"]
