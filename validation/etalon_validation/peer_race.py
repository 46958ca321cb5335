"""`validate peers --performance`: Etalon beside every peer that is there, scene by scene, in one paired session.

Each series is judged against a converged picture of its own renderer, and each
renderer's picture against Etalon's, in absolute units: a peer may be fast at
another picture, and the tables say so. A peer that is not there, cannot render a
scene or fails is left out with one line; only Etalon must run.
"""

from dataclasses import dataclass, replace
from pathlib import Path

from .converge_analysis import analyse
from .converge_data import Run, Series, write_rows
from .errors import InputError
from .peer_agreement import Agreement, agreement
from .peer_converged import converged, digest_of
from .peer_driver import drivers
from .peer_runs import etalon, peer
from .peer_scene import Scene, Spectra, read_scene
from .peer_session import costs, rounds, schedule, series_of
from .peer_study import relative, rendering_only
from .peer_variant import write_variant
from .photograph import sha256_of

OURS = "etalon"
# What makes Etalon's converged picture: the more efficient of them on the scene.
OUR_REFERENCE = ("path", "bdpt")
# Share of the budget that converged pictures get where none is kept.
REFERENCE_SHARE = 0.35
# Pixels of the longer side of a picture where no size is given.
LONGER_SIDE = 96
# How many times the CPU seconds of the smallest point a sample per pixel of the slowest series may take.
SLACK = 8
# Modules that decide what a peer is given, besides its own.
EXPORT = ("spectra", "scene", "shapes", "variant", "write", "converged", "depth", "command")


@dataclass(frozen=True)
class Entry:
    """A series that is to run: who, and the name of the converged picture that it is judged against."""

    contestant: object
    reference: str
    version: str


@dataclass(frozen=True)
class SceneResult:
    """All that came out on one scene.

    `rendering` and `whole` are the reports with the seconds of rendering alone and of whole processes;
    `agreements` and `judged_against` by series; `references` are facts of the converged pictures by name.
    """

    name: str
    changes: tuple
    resolution: tuple
    rendering: tuple
    whole: tuple
    agreements: dict
    judged_against: dict
    references: dict
    notes: tuple

    @property
    def peers(self):
        """Names of the series of other renderers."""
        return [report.name for report in self.rendering if report.name in self.agreements]

    @property
    def ours(self):
        """Names of Etalon's."""
        return [report.name for report in self.rendering if report.name not in self.agreements]


def ready_peers(chosen, notes):
    """Drivers of the peers that are there with what starts them; `notes` takes a line for each that is not."""
    found = []
    for driver in drivers(chosen.peers.split(",")) if chosen.peers else drivers():
        try:
            found.append((driver, driver.ready(chosen.target, chosen.spectra)))
        except InputError as error:
            notes.append(f"{driver.NAME} is left out: {error}")
            continue
        notes += [f"{driver.NAME}: {note}" for note in found[-1][1].notes]
    return found


def race(chosen, case, peers, say=print):
    """The `SceneResult` of one case within its share of the budget."""
    name, notes = case.name, []
    folder = chosen.folder / name
    changes = write_variant(case, chosen.spectra, folder)
    scene, size = scene_and_size(folder / "scene.json", chosen)
    entries = line_up(chosen, folder, scene, size, peers, notes)

    def drop(contestant, error):
        if not contestant.is_foreign:
            raise error
        notes.append(f"{contestant.name} is left out: {error}")
        say(f"note: {notes[-1]}")

    found = costs([entry.contestant for entry in entries], drop)
    entries = [entry for entry in entries if entry.contestant.name in found]
    share = (1 - REFERENCE_SHARE) / len(chosen.cases)
    plan = schedule(found, chosen.budget * share, chosen.threads, None, share, SLACK)
    pictures = references(chosen, folder, size, entries, peers, notes, say)
    running = [entry.contestant for entry in entries if entry.reference in pictures]
    say(f"{name}: {len(running)} series at {len(next(iter(plan.spp.values())))} budgets in turns, about {plan.expected_s:.0f} s on an idle machine")
    runs = rounds(running, plan, folder / "runs", say=say, drop=drop)
    write_rows(folder / "runs.csv", Run, [entry for done in runs.values() for entry in relative(done, folder)])
    series = [replace(series_of(contestant.name, runs[contestant.name]), is_foreign=contestant.is_foreign) for contestant in running if contestant.name in runs]
    return judge(name, changes, size, series, {entry.contestant.name: entry.reference for entry in entries}, pictures, notes)


def judge(name, changes, size, series: list[Series], judged_against, pictures, notes):
    """The `SceneResult` of runs and converged pictures."""
    own = {each.name: pictures[judged_against[each.name]].reference for each in series}
    ours = pictures[OURS]
    verdicts: dict[str, Agreement] = {reference: agreement(picture.runs, ours.runs) for reference, picture in pictures.items() if reference != OURS}
    return SceneResult(
        name=name, changes=tuple(changes), resolution=tuple(size),
        rendering=analyse([rendering_only(each) for each in series], ours.reference, own), whole=analyse(series, ours.reference, own),
        agreements={each.name: verdicts[judged_against[each.name]] for each in series if each.is_foreign},
        judged_against={each.name: judged_against[each.name] for each in series},
        references={reference: picture.facts | picture.reference.facts() for reference, picture in pictures.items()}, notes=tuple(notes),
    )


def scene_and_size(place, chosen) -> tuple[Scene, tuple]:
    """The scene in the size that is asked for, or with `LONGER_SIDE` pixels along its longer side."""
    spectra = Spectra(chosen.spectra)
    size = chosen.resolution
    if size is None:
        width, height = read_scene(place, spectra).camera.resolution
        size = tuple(round(side * LONGER_SIDE / max(width, height)) for side in (width, height))
    return read_scene(place, spectra, size), size


def line_up(chosen, folder, scene, size, peers, notes):
    """Etalon's integrators, then those of each peer that can render the scene here."""
    place = folder / "scene.json"
    version = f"binary {sha256_of(chosen.program)}"
    found = [Entry(etalon(chosen.program, place, name, size, chosen.threads, f"{OURS} {name}"), OURS, version) for name in chosen.integrators.split(",")]
    for driver, ready in peers:
        for name in driver.INTEGRATORS:
            why = ready.unable.get(name) or driver.refuses(name, scene)
            if why:
                notes.append(f"{driver.NAME} {name} is left out: {why}")
                continue
            contestant = peer(driver, ready, name, folder, chosen.spectra, size, chosen.threads)
            found.append(Entry(contestant, family(driver, name), ready.version))
    return found


def family(driver, integrator):
    """The name of the converged picture that an integrator is judged against."""
    makers = driver.REFERENCE[integrator]
    return f"{driver.NAME} {makers}" if isinstance(makers, str) else driver.NAME


def references(chosen, folder, size, entries, peers, notes, say):
    """`Converged` pictures by name, Etalon's among them; a peer whose picture cannot be made is left out."""
    budget_s = chosen.budget * REFERENCE_SHARE / len(chosen.cases)
    names = list(dict.fromkeys(entry.reference for entry in entries))
    makers = {name: makers_of(name, chosen, folder, size, entries, peers) for name in names}
    found = {}
    for name in names:
        key = key_of(name, chosen, folder, size, next(entry for entry in entries if entry.reference == name))
        try:
            found[name] = converged(name, makers[name], folder / "references", key, budget_s / len(names), chosen.threads, say)
        except InputError as error:
            if name == OURS:
                raise
            notes.append(f"{name} is left out: its converged picture cannot be made: {error}")
            say(f"note: {notes[-1]}")
    return found


def makers_of(name, chosen, folder, size, entries, peers):
    """The contestants that may make a converged picture."""
    if name == OURS:
        return [etalon(chosen.program, folder / "scene.json", each, size, chosen.threads, f"{OURS} {each}") for each in OUR_REFERENCE]
    there = {entry.contestant.name: entry.contestant for entry in entries if entry.reference == name}
    wanted = []
    for driver, _ in peers:
        for integrator, makers in driver.REFERENCE.items():
            if family(driver, integrator) == name:
                wanted += [f"{driver.NAME} {maker}" for maker in ([makers] if isinstance(makers, str) else makers)]
    # The one that is named may not be able here: then those that are judged by it make it.
    return [there[each] for each in dict.fromkeys(wanted) if each in there] or list(there.values())


def key_of(name, chosen, folder, size, entry):
    """What a converged picture stands for."""
    here = Path(__file__).parent
    harness = [here / f"peer_{part}.py" for part in EXPORT] + sorted(here.glob(f"peer_{name.split()[0]}*.py"))
    return {
        "version": entry.version, "scene": sha256_of(folder / "scene.json"), "resolution": list(size),
        "spectra": digest_of(sorted(Path(chosen.spectra).glob("*/*.csv"))), "harness": digest_of(harness),
    }
