"""Unit tests of the validation harness: `python -m unittest discover -s tests -t .` in this folder."""
