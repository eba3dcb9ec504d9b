"""Distances on a slice, as x,y,z,distance lines for other programs."""

import sys

import numpy as np

from idviewer.core import InteriorDistance, Plane, read_mesh, sample_path, slice_values

human = read_mesh(sample_path("human_2k"))
found = slice_values(InteriorDistance(human), Plane.along("y", 0.5, human.bounds), nodes=200)
table = np.column_stack([found.points, found.values])
np.savetxt(sys.stdout, table, delimiter=",", fmt="%.6g", header="x,y,z,distance", comments="")
