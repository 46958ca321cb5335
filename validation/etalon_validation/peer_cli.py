"""Subcommands around other renderers: one run of each, the convergence session against Mitsuba, the session against all."""

import argparse
from pathlib import Path

from .errors import InputError
from .peer_driver import DRIVERS, drivers, size

# Wall seconds of the session, references apart.
BUDGET_S = 180.0
INTEGRATORS = "path,bdpt,mlt"
# Of the session against all peers: wall seconds on an idle machine, converged pictures included.
RACE_BUDGET_S = 1500.0
RACE_INTEGRATORS = "path,bdpt,mlt,auto"


def add_peer_commands(commands):
    """Adds them to the subcommands of the program."""
    for driver in drivers():
        driver.add_command(commands)

    study = commands.add_parser("peers-converge", help="error against run time beside Mitsuba 3, in one paired session")
    study.add_argument("--case", type=Path, required=True, help="case folder with scene.json")
    study.add_argument("--folder", type=Path, required=True, help="folder of validate peers, with both references")
    study.add_argument("--program", type=Path, default=Path("target/release/etalon"), help="the program etalon")
    study.add_argument("--peer-python", type=Path, required=True, help="Python with Mitsuba")
    study.add_argument("--spectra", type=Path, default=Path("spectra"))
    study.add_argument("--integrators", default=INTEGRATORS)
    study.add_argument("--threads", type=int, required=True, help="of every run on both sides")
    study.add_argument("--budget", type=float, default=BUDGET_S, help=f"wall seconds of all runs together; default {BUDGET_S:g}")
    study.set_defaults(run=run_study)

    race = commands.add_parser("peers-performance", help="CPU seconds at equal error beside every peer that is there, in one paired session")
    race.add_argument("--cases", type=Path, nargs="+", required=True, help="case folders with scene.json")
    race.add_argument("--folder", type=Path, required=True, help="folder to write; converged pictures are kept in it")
    race.add_argument("--program", type=Path, default=Path("target/release/etalon"), help="the program etalon")
    race.add_argument("--program-version", dest="version", default="", help="its version, for reports")
    race.add_argument("--target", type=Path, default=Path("target"), help="folder of the peers' environments")
    race.add_argument("--spectra", type=Path, default=Path("spectra"))
    race.add_argument("--integrators", default=RACE_INTEGRATORS)
    race.add_argument("--peers", help=f"names of peers, of {','.join(DRIVERS)}; all if left out")
    race.add_argument("--resolution", type=size, metavar="WxH", help="of every scene; 96 pixels along the longer side if left out")
    race.add_argument("--threads", type=int, required=True, help="of every run on all sides")
    race.add_argument("--budget", type=float, default=RACE_BUDGET_S, help=f"seconds of all of it on an idle machine; default {RACE_BUDGET_S:g}")
    race.add_argument("--said", default="", help=argparse.SUPPRESS)
    race.set_defaults(run=run_race)


def run_study(chosen):
    """Tables, plot and report.html into the folder, and what they say."""
    from .peer_study import study

    if not chosen.budget > 0:
        raise InputError("--budget", f"is {chosen.budget:g}", "give wall seconds above zero")
    for line in study(chosen):
        print(line)


def run_race(chosen):
    """Tables, plots and performance.html into the folder, and what they say."""
    from .peer_race import race, ready_peers
    from .peer_race_report import lines, write_all

    if not chosen.budget > 0:
        raise InputError("--budget", f"is {chosen.budget:g}", "give wall seconds above zero")
    unknown = [name for name in (chosen.peers or "").split(",") if name and name not in DRIVERS]
    if unknown:
        raise InputError("--peers", f"knows no {', '.join(unknown)}", f"name some of {', '.join(DRIVERS)}")
    notes = []
    peers = ready_peers(chosen, notes)
    for note in notes:
        print(f"note: {note}", flush=True)

    def say(line):
        print(line, flush=True)

    results = []
    for case in chosen.cases:
        results.append(race(chosen, case, peers, say))
        # After each scene: a session that is cut short leaves what it has found.
        report = write_all(chosen, results, peers, notes)
    for line in lines(report):
        print(line)
