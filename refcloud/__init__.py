"""refcloud: a teaching reference for clouds, from noise to picture, in numpy."""

__version__ = "0.1.0"
