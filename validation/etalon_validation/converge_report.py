"""What a study says: `runs.csv`, `converge.csv`, `converge.json`, the plot, and short text.

The JSON holds everything that the tables and the plot are made of, with the
program, the scene and the machine; a figure that could not be had is null.
"""

import json
import math
from collections import Counter
from dataclasses import asdict

from . import __version__
from .converge_analysis import FLAGS, FLATTEST, HEAVY_SHARE, REFERENCE_SHARE, STEEPEST
from .converge_data import Point, write_rows
from .converge_plot import plot
from .converge_reference import FLOOR_SHARE
from .converge_score import TRIMMED_SHARE

DEFINITIONS = {
    "mse": "mean over pixels of (I - R)^2 less the variance of R, luminance, (cd/m2)^2",
    "relmse": f"mean over pixels of ((I - R)^2 less the variance of R) / (R^2 + e), e = ({FLOOR_SHARE:g} times the mean of R)^2",
    "trimmed": f"the same without the {TRIMMED_SHARE:.1%} of pixels with the largest terms",
    "cpu_s": "CPU seconds of the run's whole process, loading included",
    "setup_cpu_s": "those of them before the first sample that counts",
    "slope": "of the logarithm of the mean error on that of the mean CPU seconds, over the points; render: on CPU seconds after set-up, or samples per pixel where those are not known",
    "efficiency": "geometric mean over the points of 1 / (mean relMSE times mean CPU seconds), 1/s",
    "interval": "95 %, from repeats drawn again within each point, Student's t",
    "limits": {"reference_share": REFERENCE_SHARE, "heavy_share": HEAVY_SHARE, "flattest_slope": FLATTEST, "steepest_slope": STEEPEST},
    "flags": FLAGS,
}


def write(folder, facts, reference, reports):
    """All files of a study into its folder; returns their paths."""
    write_rows(folder / "converge.csv", Point, [point for report in reports for point in report.points])
    told = facts | {
        "harness_version": __version__, "reference": reference.facts(), "definitions": DEFINITIONS,
        "series": {report.name: {name: value for name, value in asdict(report).items() if name != "name"} for report in reports},
    }
    file = folder / "converge.json"
    file.write_text(json.dumps(finite(told), indent=2, allow_nan=False) + "\n", encoding="utf-8")
    return [folder / "runs.csv", folder / "converge.csv", file, *plot(reports, folder, caption(facts, reference), reference.facts()["relative_variance"])]


def finite(value):
    """The same with null for numbers that JSON has not."""
    if isinstance(value, dict):
        return {name: finite(entry) for name, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [finite(entry) for entry in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def caption(facts, reference):
    """The lines below the plot: what was measured, against what, by which program, when and where."""
    told, size = reference.facts(), "x".join(str(side) for side in facts["size"])
    against = f"the other runs of {told['series']}" if told["kind"] == "pool" else told["file"]
    machine = facts["machine"]
    yield f"{facts['scene']}, {size}, {facts['repeats']} repeats a point (lines: medians, shades: 10-90 %); reference: {against}, its noise subtracted" + ("" if told["noise"] else " where known (it is not)")
    commit = (facts.get("git_hash") or "unknown commit")[:19]
    yield from (peer["sentence"] for peer in facts.get("peers", {}).values())
    yield f"etalon {facts['version']} ({commit}), {facts['date']}, {machine['cpu']}, {facts['threads'] or machine['processors']} threads"


def describe(reports, reference):
    """The study in lines for the terminal."""
    told = reference.facts()
    whole = told["relative_variance"]
    yield f"reference: {'other runs of ' + told['series'] if told['kind'] == 'pool' else told['file']}, its own relMSE {'unknown' if whole is None else f'{whole:.2e}'}"
    for report in reports:
        last = report.points[-1]
        yield (
            f"{report.name}: relMSE {last.relmse_mean:.2e} (trimmed {last.trimmed_mean:.2e}) at {last.cpu_s:.2f} CPU s, set-up {seconds(last.setup_cpu_s)}; "
            f"slope {interval(report.fit.relmse)}; efficiency over the best {interval(report.ratio_to_best)} (trimmed {interval(report.ratio_to_best_trimmed)})"
        )
        picked = Counter(run.integrator for run in report.runs if run.integrator not in (None, report.name))
        if picked:
            yield "  picked " + ", ".join(f"{name} in {count} of {len(report.runs)} runs" for name, count in picked.most_common())
        if report.bias is not None:
            bias = report.bias
            yield f"  {verdict_of(bias, reference)}: mean over reference {interval(bias.mean_ratio, 4)}, squared relative bias {bias.squared.value:.1e} [{bias.squared.low:.1e}, {bias.squared.high:.1e}]"
        yield from (f"  flag {flag.name}: {flag.text}" for flag in report.flags)


def verdict_of(bias, reference):
    """What a bias comes to; of two series that differ neither is called the wrong one."""
    if bias.is_significant:
        return "BIASED" if reference.series is None else f"DIFFERS from {reference.series}"
    if bias.is_clear:
        return "no bias seen"
    return f"not decided (z {bias.z:.1f}, limit {bias.limit:.1f}" + (f"; {bias.doubt})" if bias.doubt else ")")


def interval(estimate, digits=2):
    """A figure with its interval; a dash where there is none, or where nothing is known of it."""
    return "-" if estimate is None or not math.isfinite(estimate.high) else f"{estimate.value:.{digits}f} [{estimate.low:.{digits}f}, {estimate.high:.{digits}f}]"


def seconds(value):
    """Seconds for the terminal."""
    return "unknown" if value is None else f"{value:.2f} s"
