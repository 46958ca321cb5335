"""The subcommand that measures how cost grows."""

import math
import os
from pathlib import Path

from .errors import InputError

# CPU seconds of all runs: some ten minutes of two processors.
BUDGET_S = 1000.0


def add_growth(commands):
    """Adds it to the subcommands of the program."""
    growth = commands.add_parser("growth", help="measure how cost grows with pixels, triangles, lamps, depth, channels and threads")
    growth.add_argument("-o", "--output", type=Path, required=True, metavar="DIR", help="folder for growth.csv, growth.json, growth.svg, growth.png and the scenes")
    growth.add_argument("--program", type=Path, default=Path("target/release/etalon"), help="the program etalon")
    growth.add_argument("--budget", type=float, default=BUDGET_S, metavar="SECONDS", help=f"CPU seconds of all runs together; default {BUDGET_S:g}")
    growth.add_argument("--threads", type=int, default=os.cpu_count() or 1, help="of every run; all processors if left out")
    growth.add_argument("--full", action="store_true", help="take every point, 3840 x 2160 pixels and 10 million triangles among them, however long that is, if memory holds it")
    growth.set_defaults(run=run_growth)


def run_growth(chosen):
    """The study's files, and its exponents in words."""
    from .growth import describe, run
    from .growth_runs import Study

    if not (math.isfinite(chosen.budget) and chosen.budget > 0):
        raise InputError("--budget", f"is {chosen.budget:g}", "give CPU seconds above zero")
    if not 1 <= chosen.threads <= 1024:
        raise InputError("--threads", f"is {chosen.threads}", "give a number from 1 to 1024")
    series = run(Study(chosen.program, chosen.output, chosen.budget, chosen.threads, chosen.full), lambda line: print(line, flush=True))
    print("\n".join(describe(series)))
    print(f"plot: {chosen.output / 'growth.svg'}")
