"""Compares an Etalon render with a photograph or with the values measured on one.

A render is scored region by region on a ladder of fits (`ladder`): nothing
fitted, one exposure, channel gains, a 3x3 matrix. The levels are reported side
by side and never mixed, so a fit cannot hide an error.
"""

__version__ = "0.1.0"
