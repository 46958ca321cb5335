"""The command `converge`: a study of one scene, or the program against an earlier one."""

import argparse
import datetime
import json
import math
import re
import sys
from dataclasses import asdict
from pathlib import Path

from .errors import InputError, read_json

INTEGRATORS = "path,bdpt,mlt"
# CPU seconds of the largest budget of a study, and of a run that is compared with an earlier program's.
BUDGET_S = 16.0
BASELINE_BUDGET_S = 2.0
POINTS = 5
# With five doubling budgets of eight repeats the pooled reference, a run left out, has 0.07 of a run's variance.
REPEATS = 8
FEWEST_REPEATS = 5
FACTOR = 1.1
# The scenes that an earlier program is compared on where none is named.
REFERENCE = Path(__file__).parents[2] / "reference"


def add_converge(commands):
    """The subcommand and its arguments."""
    command = commands.add_parser("converge", help="error against CPU seconds of several integrators, or efficiency against an earlier program")
    command.add_argument("scenes", nargs="*", type=Path, metavar="SCENE.json")
    command.add_argument("--program", type=Path, default=Path("target/release/etalon"), help="the program etalon")
    command.add_argument("--integrators", default=INTEGRATORS, help="names, separated by commas")
    command.add_argument("--budget", type=positive_number, help=f"CPU seconds of the largest runs; default {BUDGET_S:g}, with --baseline {BASELINE_BUDGET_S:g}")
    command.add_argument("--points", type=int, default=POINTS, help="doubling budgets")
    command.add_argument("--repeats", type=int, default=REPEATS, help="independent runs of each budget, or pairs")
    command.add_argument("--reference", type=Path, help="EXR of the scene whose unit is known; without it a run is judged by the other runs")
    command.add_argument("--resolution", type=resolution, help="WxH; default the reference's, or the scene's own")
    command.add_argument("--threads", type=int, help="threads of each run; default all processors")
    command.add_argument("--baseline", type=Path, help="the program of an earlier commit")
    command.add_argument("--factor", type=positive_number, default=FACTOR, help="by how much efficiency may fall")
    command.add_argument("--allow-difference", action="store_true", help="with --baseline: pictures that differ beyond noise are no failure")
    command.add_argument("--peer", action="append", metavar="NAME=FILE.csv", help="another renderer's pictures: a table with the columns cpu_seconds,file")
    command.add_argument("--peer-scale", action="append", metavar="NAME=K", help="cd/m2 per unit of its files, where they do not say")
    command.add_argument("--peer-reference", action="append", metavar="NAME=REF.exr", help="its own converged picture")
    command.add_argument("-o", "--output", type=Path, required=True)
    command.set_defaults(run=run_converge)


def positive_number(text):
    """A number above zero, as argparse wants it."""
    number = float(text)
    if not number > 0 or not math.isfinite(number):
        raise argparse.ArgumentTypeError(f"{text} is not above zero")
    return number


def resolution(text):
    """Width and height as in 640x480, as argparse wants it."""
    if not re.fullmatch(r"[1-9][0-9]*[xX][1-9][0-9]*", text):
        raise argparse.ArgumentTypeError(f"{text} is no size, such as 640x480")
    return text


def run_converge(chosen):
    """Studies of the scenes, or comparisons with an earlier program; exit code 1 where efficiency fell."""
    from .peer_series import peer_options
    from .peer_table import read_table

    if chosen.repeats < FEWEST_REPEATS:
        raise InputError("--repeats", f"{chosen.repeats} runs do not tell how much runs scatter", f"give at least {FEWEST_REPEATS}")
    if chosen.points < 1:
        raise InputError("--points", "there must be a budget", "give 1 or more, such as 5")
    chosen.names = tuple(dict.fromkeys(name for name in chosen.integrators.split(",") if name))
    if not chosen.names:
        raise InputError("--integrators", "names none", f"give one or more, as in {INTEGRATORS}")
    chosen.peers = peer_options(chosen.peer, chosen.peer_scale, chosen.peer_reference)
    for peer in chosen.peers:
        # Before anything is run; once more when the size of pictures is known.
        read_table(peer.name, peer.file)
    if chosen.peers and (chosen.baseline or len(chosen.scenes) > 1):
        raise InputError("--peer", "goes with one scene, and not with --baseline", "name the scene that it shows")
    if chosen.allow_difference and not chosen.baseline:
        raise InputError("--allow-difference", "goes with --baseline", "leave it out")
    if chosen.reference and len(chosen.scenes) > 1:
        raise InputError("--reference", "is a picture of one scene", "name that scene alone, or leave the reference out")
    chosen.program = chosen.program.resolve()
    for scene in chosen.scenes:
        read_json(scene, "give a scene")
    if chosen.baseline:
        return run_baseline(chosen)
    if not chosen.scenes:
        raise InputError("SCENE.json", "is missing", "name one or more scenes; only --baseline has scenes of its own")
    for scene in chosen.scenes:
        study(chosen, scene, chosen.output if len(chosen.scenes) == 1 else chosen.output / name_of(scene))
    if len(chosen.scenes) > 1:
        from .converge_overview import write_overview

        say("overview: " + ", ".join(str(path) for path in write_overview(chosen.output)))
    return 0


def name_of(scene):
    """What a scene is called: its file, or the folder of a scene.json."""
    return scene.resolve().parent.name if scene.name == "scene.json" else scene.stem


def say(line):
    """A line for who is waiting."""
    print(line, flush=True)


def study(chosen, scene, folder):
    """One scene: runs, reports and plot into its folder, those of other renderers beside them."""
    from .converge_analysis import analyse
    from .converge_pool import pooled_reference
    from .converge_reference import read_reference
    from .converge_report import describe, write
    from .converge_runs import Job, machine
    from .converge_study import Asked, finish, make_all, prepared, series_of
    from .peer_series import load_peer, peers_in_report, settle_peer

    size = [int(side) for side in chosen.resolution.lower().split("x")] if chosen.resolution else None
    reference = read_reference(chosen.reference, size) if chosen.reference else None
    resolution = chosen.resolution or ("{1}x{0}".format(*reference.luminance.shape) if reference else None)
    # A run with the reference's seed might share its random numbers.
    taken = reference.seeds if reference else ()
    job = Job(scene, resolution, chosen.threads)
    asked = Asked(chosen.program, chosen.names, chosen.budget or BUDGET_S, chosen.points, chosen.repeats)
    folder.mkdir(parents=True, exist_ok=True)
    before, date = machine(), datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d")
    plan = prepared(asked, job, folder, taken, reference.check_scene if reference else lambda _facts: None)
    if reference is not None:
        reference = read_reference(chosen.reference, plan["size"])
    # Before runs that may take hours.
    loaded = [load_peer(option, plan["size"], chosen.names) for option in chosen.peers]
    made = make_all(asked, job, plan, folder, taken, say)
    found = series_of(made, plan, folder)
    reference = reference or pooled_reference(found)
    peers = [settle_peer(each, reference.luminance) for each in loaded]
    reports = analyse(found + [peer.series for peer in peers], reference, {peer.series.name: peer.own for peer in peers if peer.own})
    facts = plan["facts"] | {
        "scene_file": str(scene), "size": plan["size"], "date": date, "threads": chosen.threads, "machine": before | {"load_average_after": machine()["load_average"]},
        "budget_cpu_s": asked.budget_s, "repeats": asked.repeats, "trials": plan["trials"], "missing": plan["missing"],
    }
    if peers:
        facts["peers"] = peers_in_report(peers, reference)
    paths = write(folder, facts, reference, reports)
    # Not before: whatever keeps a report from being written, what was measured is there for the next try.
    finish(folder, made)
    for line in [*describe(reports, reference), *(peer.sentence for peer in peers)]:
        say(line)
    say("written: " + ", ".join(str(path) for path in paths))


def run_baseline(chosen):
    """`baseline.json`, and a line for each scene and integrator; exit code 1 where efficiency fell or pictures differ."""
    from .converge_baseline import check_program, complaints, describe, judge, measure
    from .converge_runs import Job, machine
    from .photograph import sha256_of

    if chosen.reference:
        raise InputError("--reference", "does not go with --baseline, which judges by scatter", "leave one of them out")
    if not chosen.factor > 1:
        raise InputError("--factor", f"{chosen.factor:g} is no fall", "give a number above 1, such as 1.1")
    check_program(chosen.baseline)
    old, found = chosen.baseline.resolve(), []
    chosen.output.mkdir(parents=True, exist_ok=True)
    programs = {name: {"file": str(file), "sha256": sha256_of(file)} for name, file in (("old", old), ("new", chosen.program))}
    told = {"date": datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d"), "machine": machine(), "programs": programs, "factor": chosen.factor}
    for scene in chosen.scenes or sorted(REFERENCE.glob("*/scene.json")):
        job = Job(scene, chosen.resolution, chosen.threads)
        for integrator in chosen.names:
            pairs, spp = measure(old, chosen.program, job, integrator, chosen.budget or BASELINE_BUDGET_S, chosen.repeats)
            found.append(judge(pairs, chosen.factor, name_of(scene), integrator, spp))
            # After each: what ends the command early leaves what was measured.
            write_whole(chosen.output / "baseline.json", told | {"comparisons": [asdict(entry) for entry in found]})
            say(describe(found[-1], chosen.factor))
    failures = [line for entry in found for line in complaints(entry, chosen.factor, chosen.allow_difference)]
    for line in failures:
        print(f"error: {line}", file=sys.stderr)
    for entry in found:
        if entry.verdict == "undecided":
            print(f"warning: {entry.scene}, {entry.integrator}: undecided whether efficiency fell; give more --repeats or --budget", file=sys.stderr)
    return 1 if failures else 0


def write_whole(file, value):
    """JSON in place of what the file held, whole or not at all."""
    from .converge_report import finite

    part = file.with_name(file.name + ".part")
    part.write_text(json.dumps(finite(value), indent=2, allow_nan=False) + "\n", encoding="utf-8")
    part.replace(file)
