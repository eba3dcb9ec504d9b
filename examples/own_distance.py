"""A distance of one's own: any embedding of the vertices is carried inside."""

from dataclasses import dataclass

import numpy as np

from idviewer.core import Diffusion, InteriorDistance, read_mesh, sample_path


@dataclass(frozen=True)
class Biharmonic(Diffusion):
    """Lipman, Rustamov and Funkhouser 2010: the embedding is phi / lambda."""

    title = "Biharmonic distance"

    def scale(self, spectrum):
        return 1.0 / spectrum.values


octopus = read_mesh(sample_path("octopus_2k"))
points = octopus.vertices[:5]
for distance in (Diffusion(), Biharmonic()):
    solver = InteriorDistance(octopus, distance)
    field = solver.field(solver.barycentroid().point, points)
    print(f"{distance.title}: {np.array2string(field, precision=4)}")
