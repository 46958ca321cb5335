"""What a session against peers says: performance.json, .csv, .md and .html, and a plot of each scene.

The Markdown is made to stand in a README: date, machine and command are in it.
"""

import csv
import json
from dataclasses import asdict

from .converge_report import finite
from .converge_runs import machine
from .page import svg, today, write_page
from .peer_agreement import BLOCK, BLOCK_MARGIN, FALSE_ALARM, MEAN_MARGIN
from .peer_converged import RUNS
from .peer_race_plot import draw, write
from .peer_ratios import headline, is_heavy, ratios
from .peer_session import REPEATS

STEM = "performance"
RULE = f"A peer's picture agrees with Etalon's where neither its mean nor any block of {BLOCK} x {BLOCK} pixels differs by more than {MEAN_MARGIN:.0%} and {BLOCK_MARGIN:.0%} beyond noise ({RUNS} independent runs of each side, Welch's t, Sidak over all tests, false alarm {FALSE_ALARM:.0%}); it is undecided where the noise itself is larger than that. Levels are absolute on both sides, nothing is fitted."
MEANING = "Ratios are of efficiencies 1 / (relMSE x CPU seconds), the geometric mean over the budgets, which is the ratio of CPU seconds at equal error; above 1 Etalon needs less. Each renderer is judged against a converged picture of its own, whose noise is subtracted. CPU seconds of rendering leave out start, imports, reading the scene, compilation and writing; Etalon's pilot and bootstrap are in. Trimmed leaves out the 0.1 % of pixels with the largest errors and counts where a series' error is that of a few pixels. Intervals are 95 %, from the scatter of the repeats."


def report_of(chosen, results, peers, notes):
    """performance.json."""
    return finite({
        "made": today(), "machine": machine(), "command": chosen.said, "threads": chosen.threads, "budget_s": chosen.budget, "repeats": REPEATS,
        "etalon": chosen.version, "peers": {driver.NAME: ready.version for driver, ready in peers}, "notes": notes, "meaning": MEANING, "rule": RULE,
        "scenes": [scene_of(result) for result in results],
        "headline": [row_of(row) for result in results for row in headline(result)],
    })


def row_of(row):
    """A ratio as JSON."""
    return asdict(row) | {"counts": asdict(row.counts) if row.counts else None}


def scene_of(result):
    """One scene of performance.json."""
    whole = {report.name: report for report in result.whole}
    return {
        "scene": result.name, "changes": result.changes, "resolution": result.resolution, "notes": result.notes, "references": result.references,
        "series": [series_of(report, whole[report.name], result) for report in result.rendering],
        "ratios": [row_of(row) for row in ratios(result)],
    }


def series_of(report, whole, result):
    """A series: efficiencies, slope, agreement, and its points with the seconds of rendering and of the whole process."""
    agreement = result.agreements.get(report.name)
    return {
        "name": report.name, "is_foreign": agreement is not None, "judged_against": result.judged_against[report.name],
        "agreement": None if agreement is None else asdict(agreement) | {"words": agreement.words},
        "efficiency": report.efficiency, "efficiency_trimmed": report.efficiency_trimmed, "efficiency_process": whole.efficiency,
        "is_heavy_tailed": is_heavy(report), "slope": report.fit.relmse and asdict(report.fit.relmse),
        "points": [
            {"spp": point.spp, "render_cpu_s": point.cpu_s, "process_cpu_s": both.cpu_s, "relmse": point.relmse_mean, "relmse_median": point.relmse_median, "relmse_trimmed": point.trimmed_mean}
            for point, both in zip(report.points, whole.points)
        ],
        "flags": [asdict(flag) for flag in report.flags],
    }


def write_all(chosen, results, peers, notes):
    """All files into the folder; returns the report."""
    report = report_of(chosen, results, peers, notes)
    folder = chosen.folder
    (folder / f"{STEM}.json").write_text(json.dumps(report, indent=1, allow_nan=False) + "\n", encoding="utf-8")
    (folder / f"{STEM}.md").write_text("\n".join(markdown(report)) + "\n", encoding="utf-8")
    write_csv(folder / f"{STEM}.csv", report)
    plots = []
    for result, scene in zip(results, report["scenes"]):
        figure = draw(result.rendering, caption(report, scene))
        write(figure, folder, f"{STEM}-{result.name}")
        plots.append(svg(figure))
    write_page(folder / f"{STEM}.html", "performance.html.jinja", report=report, plots=plots, ratio=ratio_words)
    return report


def ratio_words(estimate):
    """A ratio with its interval; a dash where there is none."""
    if estimate is None:
        return "–"
    if estimate["high"] is None:
        return f"{estimate['value']:.3g}"
    return f"{estimate['value']:.3g} [{estimate['low']:.3g}, {estimate['high']:.3g}]"


def caption(report, scene):
    """The lines below a plot."""
    yield f"{scene['scene']}, {scene['resolution'][0]} x {scene['resolution'][1]} pixels, {report['threads']} threads each, {report['repeats']} repeats in turns; {', '.join(report['peers'].values()) or 'no peer'} beside Etalon {report['etalon']}. Lines join medians, shades are 10-90 %."
    if scene["changes"]:
        yield f"Changed for all renderers: {'; '.join(scene['changes'])}"
    yield "Each against a converged picture of its own renderer, its noise subtracted: " + "; ".join(f"{name} by {facts['integrator']}, own relMSE {facts['relative_variance']:.1e}" for name, facts in scene["references"].items())
    yield f"{report['made']}, {report['machine']['cpu']}, {report['machine']['processors']} processors, {report['machine']['system']}"


def markdown(report):
    """The tables as lines of Markdown."""
    yield f"{report['made']}, {report['machine']['cpu']}, {report['machine']['processors']} processors, {report['machine']['system']}, {report['threads']} threads each; Etalon {report['etalon']}, {', '.join(report['peers'].values()) or 'no peer'}: `{report['command']}`"
    yield ""
    yield "| scene | Etalon's best | peer's best | CPU seconds of the peer over Etalon's at equal error | whole processes | the peer's picture |"
    yield "|---|---|---|---|---|---|"
    for row in report["headline"]:
        process = row["process_trimmed"] if row["is_trimmed"] else row["process"]
        yield f"| {row['scene']} | {row['ours']} | {row['peer']} | **{ratio_words(row['counts'])}**{' (trimmed)' if row['is_trimmed'] else ''} | {ratio_words(process)} | {row['verdict']} |"
    for scene in report["scenes"]:
        yield ""
        yield f"{scene['scene']}, {scene['resolution'][0]} x {scene['resolution'][1]}" + (f"; changed for all: {'; '.join(scene['changes'])}" if scene["changes"] else "")
        yield ""
        yield "| series | spp | CPU s of rendering | relMSE at the last budget (trimmed) | efficiency, 1/s (trimmed) | whole process, 1/s | the picture against Etalon's |"
        yield "|---|---|---|---|---|---|---|"
        for series in scene["series"]:
            first, last = series["points"][0], series["points"][-1]
            agreement = series["agreement"]["words"] if series["agreement"] else "–"
            yield f"| {series['name']} | {first['spp']}–{last['spp']} | {first['render_cpu_s']:.2g}–{last['render_cpu_s']:.2g} | {last['relmse']:.3g} ({last['relmse_trimmed']:.3g}) | {number(series['efficiency'])} ({number(series['efficiency_trimmed'])}) | {number(series['efficiency_process'])} | {agreement} |"
    yield ""
    yield report["meaning"]
    yield ""
    yield report["rule"]
    for note in [*report["notes"], *(f"{scene['scene']}: {note}" for scene in report["scenes"] for note in scene["notes"])]:
        yield f"- {note}"


def number(value):
    """Three digits; a dash where there is nothing."""
    return "–" if value is None else f"{value:.3g}"


def write_csv(file, report):
    """A line for each pair of a series of Etalon and one of a peer."""
    names = ["scene", "ours", "peer", "verdict", "is_trimmed"] + [f"{key}_{part}" for key in ("rendering", "rendering_trimmed", "process", "process_trimmed") for part in ("value", "low", "high")]
    with file.open("w", newline="", encoding="utf-8") as text:
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(names)
        for scene in report["scenes"]:
            for row in scene["ratios"]:
                estimates = [row[key] or {} for key in ("rendering", "rendering_trimmed", "process", "process_trimmed")]
                writer.writerow([row[name] for name in names[:5]] + [estimate.get(part) for estimate in estimates for part in ("value", "low", "high")])


def lines(report):
    """What is printed."""
    for row in report["headline"]:
        yield f"{row['scene']}: {row['ours']} over {row['peer']} ({row['verdict']}): {ratio_words(row['counts'])} times as efficient{', trimmed' if row['is_trimmed'] else ''}"
    if not report["headline"]:
        yield "no peer was there to be compared with; the notes say why"
