"""Interior distance between two points of a hand, by both of the paper's formulas."""

import numpy as np

from idviewer.core import InteriorDistance, gram_distance, read_mesh, sample_path

hand = read_mesh(sample_path("hand"))
solver = InteriorDistance(hand)
centre = solver.barycentroid().point
top = hand.vertices[hand.vertices[:, 2].argmax()]
print(f"from {centre.round(3)} to {top.round(3)}, {len(solver.spectrum.values)} modes")
print(f"interior, eq. 1: {solver.distance([centre], [top])[0]:.6g}")
print(f"interior, eq. 2: {gram_distance(solver, [centre], [top])[0]:.6g}")
print(f"Euclidean:       {np.linalg.norm(centre - top):.6g}")
