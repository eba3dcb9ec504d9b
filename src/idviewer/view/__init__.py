"""The window and the pictures: the only layer that knows Qt and VTK."""
