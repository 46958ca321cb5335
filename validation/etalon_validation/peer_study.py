"""`validate peers`, second part: error against run time beside Mitsuba 3.

Every series is judged against a converged picture of its own renderer, those
that the block comparison has just held against each other: how fast each gets
to its own answer. That the answers agree is the first part; how far a series
ends from the other renderer's picture is stated beside it.
"""

import json
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from .converge_analysis import analyse, report_on
from .converge_data import Run, write_rows
from .converge_fit import ratio_to
from .converge_plot import plot
from .converge_report import finite
from .converge_reference import read_reference
from .converge_runs import machine
from .errors import read_json
from .page import today
from .peer_llvm import usable
from .peer_mitsuba import LLVM, SCALAR
from .peer_runs import etalon, mitsuba
from .peer_series import PeerOption, load_peer, settle_peer
from .peer_session import REFERENCE_LEAD, REPEATS, costs, rounds, schedule, series_of, write_peer
from .peers import REFERENCE_FILE
from .render import read_render

FOLDER = "converge"
RENDERING = "CPU seconds of rendering alone"
OURS = "render.exr"
# What the trial of a library renders.
TRIAL_SIZE = (16, 16)


@dataclass(frozen=True)
class Judged:
    """Reports of all series in the order of the legend, with the seconds of whole processes and of rendering alone.

    `peers` by name, and their reports against our reference.
    """

    reports: tuple
    rendering: tuple
    peers: dict
    crossed: dict


def study(chosen):
    """Runs the session, writes tables, plot and page, and returns what they say, line by line."""
    folder = chosen.folder / FOLDER
    folder.mkdir(parents=True, exist_ok=True)
    render = read_render(chosen.folder / OURS)
    contestants, notes = line_up(chosen, render.size)
    for note in notes:
        print(f"note: {note}")
    most_spp = render.record["samples_per_pixel"] // REFERENCE_LEAD
    plan = schedule(costs(contestants), chosen.budget, chosen.threads, most_spp)
    print(f"{len(contestants)} series at {len(next(iter(plan.spp.values())))} budgets, {REPEATS} repeats, in turns: about {plan.expected_s:.0f} s")
    runs = rounds(contestants, plan, folder, render.record.get("seed") or 0)
    write_rows(folder / "runs.csv", Run, [entry for found in runs.values() for entry in relative(found, folder)])
    judged = judge(chosen, contestants, runs, folder)
    report = report_of(chosen, render, judged, notes)
    (folder / "converge.json").write_text(json.dumps(finite(report), indent=2, allow_nan=False) + "\n", encoding="utf-8")
    floor = report["reference"]["relative_variance"]
    plot(judged.reports, folder, caption(report), floor)
    plot(judged.rendering, folder, caption(report), floor, stem="rendering", seconds=RENDERING)
    from .peer_page import write_peer_page

    write_peer_page(chosen.folder, finite(report), judged)
    return lines(report)


def line_up(chosen, size):
    """Etalon's integrators, then the variants of Mitsuba that run here; and notes on those that do not."""
    found = [etalon(chosen.program, chosen.case / "scene.json", name, size, chosen.threads) for name in chosen.integrators.split(",")]
    there = (chosen.peer_python, chosen.case, chosen.spectra)
    found.append(mitsuba(*there, size, chosen.threads, SCALAR))
    trial = mitsuba(*there, TRIAL_SIZE, chosen.threads, LLVM)
    library, note = usable(lambda output, times: trial.words(1, 0, output, times), trial.environment)
    if library is not None:
        found.append(mitsuba(*there, size, chosen.threads, LLVM, library))
    return found, [note]


def relative(runs, folder):
    """Runs whose files are named relative to a folder."""
    return [replace(entry, file=str(Path(entry.file).relative_to(folder))) for entry in runs]


def judge(chosen, contestants, runs, folder):
    """Everybody against a reference of the own renderer; peers also against ours."""
    ours = read_reference(chosen.folder / OURS)
    series, own, peers = [], {}, {}
    for contestant in contestants:
        if not contestant.is_foreign:
            series.append(series_of(contestant.name, runs[contestant.name]))
            continue
        table = folder / f"{contestant.name.replace(' ', '-')}.csv"
        write_peer(table, runs[contestant.name], chosen.folder / REFERENCE_FILE)
        peer = settle_peer(load_peer(PeerOption(contestant.name, table), ours.luminance.shape[::-1]), ours.luminance)
        peers[contestant.name] = peer
        series.append(peer.series)
        own[contestant.name] = peer.own
    crossed = {name: report_on(peer.series, ours) for name, peer in peers.items()}
    return Judged(analyse(series, ours, own), analyse([rendering_only(each) for each in series], ours, own), peers, crossed)


def rendering_only(series):
    """The series with the seconds of rendering in place of those of the whole process; pilot and bootstrap are work for the picture."""
    runs = (replace(entry, cpu_s=entry.render_cpu_s + (entry.pilot_cpu_s or 0.0) + (entry.bootstrap_cpu_s or 0.0), load_cpu_s=None, render_cpu_s=None) for entry in series.runs)
    return replace(series, runs=tuple(runs))


def compared(judged):
    """Efficiency of each integrator over that of each peer: of whole processes, and of rendering alone."""
    rows = []
    both = {"process": judged.reports, "rendering": judged.rendering}
    names = [report.name for report in judged.reports]
    for peer in (name for name in names if name in judged.peers):
        for ours in (name for name in names if name not in judged.peers):
            row = {"integrator": ours, "peer": peer}
            for of, reports in both.items():
                by_name = {report.name: report for report in reports}
                for kind, key in (("relmse", of), ("relmse_trimmed", f"{of}_trimmed")):
                    found = ratio_between(by_name[ours], by_name[peer], kind)
                    row[key] = found and asdict(found)
            rows.append(row)
    return rows


def ratio_between(one, other, kind):
    """Efficiency of one series over that of another; `None` where either has none."""
    able = (each.efficiency if kind == "relmse" else each.efficiency_trimmed for each in (one, other))
    return None if None in able else ratio_to(one, other, kind)


def report_of(chosen, render, judged, notes):
    """converge.json: who ran, against what, and what came out."""
    ours = read_reference(chosen.folder / OURS)
    peer_json = read_json(chosen.folder / "peers.json", "run validate peers")
    return {
        "scene": render.record.get("scene"), "resolution": list(render.size), "threads": chosen.threads, "repeats": REPEATS, "budget_s": chosen.budget,
        "made": today(), "machine": machine(), "etalon": render.record.get("version"), "peer": {key: peer_json["peer"][key] for key in ("name", "version")},
        "notes": notes,
        "reference": ours.facts() | {"integrator": render.record.get("integrator"), "samples_per_pixel": render.record.get("samples_per_pixel")},
        "peers": {
            name: peer.facts | {"against_our_reference": asdict(judged.crossed[name].bias) if judged.crossed[name].bias else None}
            for name, peer in judged.peers.items()
        },
        "series": [{key: value for key, value in asdict(report).items() if key not in ("runs", "scores")} for report in judged.reports],
        "efficiency_over_peer": compared(judged),
    }


def caption(report):
    """The lines below the plot."""
    reference = report["reference"]
    noise = [f"etalon {reference['file']}, {reference['integrator']} at {reference['samples_per_pixel']} spp, own relMSE {reference['relative_variance']:.1e}"]
    for name, facts in report["peers"].items():
        noise.append(f"{name} {facts['own_reference']['file']}, own relMSE {facts['own_reference']['relative_variance']:.1e}")
    return [
        f"{report['scene']}, {report['resolution'][0]} x {report['resolution'][1]} pixels, {report['threads']} threads each, {report['repeats']} repeats in turns; {report['peer']['name']} {report['peer']['version']} beside Etalon {report['etalon']}",
        f"Each against a converged picture of its own renderer, its noise subtracted: {'; '.join(noise)}",
        f"{report['made']}, {report['machine']['cpu']}, {report['machine']['processors']} processors, {report['machine']['system']}",
    ]


def lines(report):
    """What is printed."""
    found = []
    for row in report["efficiency_over_peer"]:
        found.append(f"{row['integrator']} over {row['peer']}: {words(row['rendering'])} times as efficient in rendering (trimmed {words(row['rendering_trimmed'])}), whole processes {words(row['process'])}")
    for name, facts in report["peers"].items():
        bias = facts["against_our_reference"]
        if bias:
            ratio = bias["mean_ratio"]
            found.append(f"{name} against Etalon's reference: mean ratio {ratio['value']:.4f} [{ratio['low']:.4f}, {ratio['high']:.4f}], {facts['unit']}")
    for series in report["series"]:
        found += [f"{series['name']}: {flag['name']}: {flag['text']}" for flag in series["flags"]]
    return found


def words(estimate):
    """A ratio with its interval."""
    if estimate is None:
        return "unknown"
    return f"{estimate['value']:.3g} [{estimate['low']:.3g}, {estimate['high']:.3g}]"

