"""Compiled loops of the mean value and maximum entropy coordinates, face by face."""
