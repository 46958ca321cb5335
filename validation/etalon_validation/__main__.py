"""`python -m etalon_validation`."""

import sys

from .cli import main

sys.exit(main())
