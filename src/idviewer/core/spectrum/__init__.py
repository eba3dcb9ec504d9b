"""Spectrum: Laplacians of boundaries and their eigenpairs."""

from idviewer.core.spectrum.eigen_solver import (
    SOLVER_VERSION,
    Spectrum,
    eigenpair_steps,
    eigenpairs,
    paper_cutoff,
    paper_time,
)
from idviewer.core.spectrum.laplacian import laplacian_of, masses_of
from idviewer.core.spectrum.memory_estimate import available_bytes, check_memory, needed_bytes, vertices_for
from idviewer.core.spectrum.resolution import Refine, Resolved, checked_refinement, resolved_steps

__all__ = [
    "SOLVER_VERSION",
    "Refine",
    "Resolved",
    "Spectrum",
    "available_bytes",
    "check_memory",
    "checked_refinement",
    "eigenpair_steps",
    "eigenpairs",
    "laplacian_of",
    "masses_of",
    "needed_bytes",
    "paper_cutoff",
    "paper_time",
    "resolved_steps",
    "vertices_for",
]
