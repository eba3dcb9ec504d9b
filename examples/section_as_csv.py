"""Distances on a slice, as x,y,z,distance lines for other programs."""

import sys

import numpy as np

from idviewer.core import InteriorDistance, Plane, read_mesh, sample_path, section
from idviewer.core.slices.triangulation import slice_mesh, spacing_for

human = read_mesh(sample_path("human_2k"))
solver = InteriorDistance(human)
cut = section(human, Plane.along("y", 0.5, human.bounds))
points = slice_mesh(cut, spacing_for(cut, 200)).node_points
distances = solver.field(solver.barycentroid().point, points)
table = np.column_stack([points, distances])
np.savetxt(sys.stdout, table, delimiter=",", fmt="%.6g", header="x,y,z,distance", comments="")
