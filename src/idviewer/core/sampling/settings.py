"""Settings of sampling: how densely and how accurately slices are sampled."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class SamplingSettings:
    """Settings of sampling slices.

    Attributes:
        coarsest_nodes: lattice nodes inside a slice at its first level.
        lattices: levels with a lattice of their own, at most; each is half as wide as the one before.
        extra_midpoints: midpoints of edges sampled at the first level besides, where interpolating would be
            worst.
        checked_midpoints: of these, those taken evenly among the others: they tell what interpolating
            costs elsewhere.
        neighbour_weight: how much the error expected at an edge's neighbours counts where edges are chosen.
        band_midpoints: midpoints of band edges sampled at finer levels, at most, for each node.
        longest_part: into which edges of a polygon are divided, in constants of the coarsest lattice.
        coarse_rtol: tolerance of samples on the first two levels, in largest distances on the slice.
        fine_rtol: on the levels after these; smallest tolerance that the tree of `loosest_rtol` serves, too.
        final_rtol: on the last level, in largest distances on the boundary; 0 is exact.
        source_rtol: of a source's own sample while the exact one is not there, in the same unit.
        loosest_rtol: a larger tolerance would take one more tree, and its memory, and save little.
        finest_rtol: the smallest tolerance that there is a tree for.
        exact_facets: on shapes up to so large, sampling exactly takes no longer than within a tolerance.
        exact_columns: of the basis from which on the moments of clusters take more memory and time than they
            save.
        tree_products: facets times columns up to which there is memory (a gigabyte) for the tree of
            `finest_rtol`.
        significant_share: columns that weigh less than this share of the heaviest do not tell where errors
            are large.
        outline_points: so many points of an outline tell how large the distances on a slice are.
        boundary_vertices: so many vertices tell how large they are on the whole shape.
        kept_bases: bases whose samples are kept of a shape.
        kept_planes, kept_points: planes and points whose samples are kept of a basis.
        basis_numbers: of the basis on the finest level of a slice (240 MB).
        facet_visits: work spent on the exact level of a slice: a few seconds on two cores, with mean value
            coordinates.
    """

    coarsest_nodes: int = 400
    lattices: int = 3
    extra_midpoints: int = 320
    checked_midpoints: int = 30
    neighbour_weight: float = 0.2
    band_midpoints: float = 0.15
    longest_part: float = 0.6
    coarse_rtol: float = 2.5e-3
    fine_rtol: float = 3.5e-4
    final_rtol: float = 0.0
    source_rtol: float = 2e-5
    loosest_rtol: float = 1.9e-3
    finest_rtol: float = 2e-5
    exact_facets: int = 4000
    exact_columns: int = 400
    tree_products: float = 4e7
    significant_share: float = 0.03
    outline_points: int = 200
    boundary_vertices: int = 5000
    kept_bases: int = 4
    kept_planes: int = 6
    kept_points: int = 8
    basis_numbers: float = 3e7
    facet_visits: float = 1.2e9


SAMPLING = SamplingSettings()
