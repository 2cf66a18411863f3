"""The scalar twins: one point, ray, splat or pixel at a time, in plain Python.

Each function has the name, the units and the meaning of the array function it defines.
"""
