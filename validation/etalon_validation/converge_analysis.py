"""From runs to points, slopes, efficiencies and flags; the same for every series, whoever made it.

Means over repeats are what expectations are: fits and efficiencies use them.
Medians and bands are what one run is likely to give: plots show them. Flags are
rules that were fixed before anything was measured; `FLAGS` says each.
"""

from dataclasses import replace

import numpy as np

from .converge_bias import FACTOR_ALPHA, FEWEST_BLOCKS, LEAST_SIGMAS, bias_of, doubt_of
from .converge_data import Flag, Point, SeriesReport
from .converge_fit import fit_of, mean_of, ratio_to
from .converge_score import score_series

# The reference's variance over an error above which it is no longer small beside it.
REFERENCE_SHARE = 0.1
# Share of the largest 0.1 % of pixels, or of one repeat, above which a mean is that of a few.
HEAVY_SHARE = 0.5
# Slopes of a Monte Carlo estimator lie between; an interval wholly outside is flagged.
FLATTEST, STEEPEST = -0.9, -1.1
BAND_PERCENT = (10, 50, 90)
# Repeats of a point below which its scatter is hardly known.
FEWEST_REPEATS = 5
FLAGS = {
    "heavy tail": "the largest 0.1 % of pixels hold more than half of a run's error (median over repeats), or one repeat more than half of its point's",
    "bias floor": f"the mean squared difference from the reference is beyond the noise of both by more standard errors than `limit`: at least {LEAST_SIGMAS:g}, and so many that a factor of the whole picture passes them with a chance of {FACTOR_ALPHA:g}; not where the reference floor is flagged, nor where a render of fewer than {FEWEST_BLOCKS} blocks is the reference",
    "disagreement": "without a reference file: the same test between a series and the one whose runs are the reference; one of the two misses light, or has too much, and both are flagged",
    "few repeats": f"a point has fewer than {FEWEST_REPEATS} runs: intervals are hardly known, and there are none where a point has one run",
    "reference floor": f"the reference's own relative mean squared error is above {REFERENCE_SHARE:g} of the smallest one plotted",
    "reference noise unknown": "the reference does not tell its standard errors: nothing was subtracted",
    "flat slope": f"the slope's 95 % interval lies above {FLATTEST}: infinite variance, bias or the reference's noise",
    "steep slope": f"the slope's 95 % interval lies below {STEEPEST}: better than independent samples, or error before the first budget",
    "error not above zero": "the mean error of a point is not above zero after the reference's noise was subtracted: it is left out of fits",
}


def analyse(series_list, reference, own=None):
    """A `SeriesReport` per series, in their order.

    `reference` is a `FileReference` or a `PooledReference`; pictures must have its size. `own` holds,
    by name, the references of series that are judged against one of their own.
    """
    reports = [report_on(series, (own or {}).get(series.name, reference)) for series in series_list]
    if reference.series is not None:
        foreign = {series.name for series in series_list if series.is_foreign}
        reports = disagreements(reports, reference.series, set(own or {}) | foreign)
    return tuple(ratios(reports))


def disagreements(reports, name, others):
    """The reports, that of the pooled series flagged too where one differs from it; `others` are by other definitions or references."""
    apart = [report.name for report in reports if report.name not in others and any(flag.name == "disagreement" for flag in report.flags)]
    words = "; ".join(f"differs from `{other}`: one of the two misses light" for other in apart)
    return [replace(report, flags=(*report.flags, Flag("disagreement", words))) if apart and report.name == name else report for report in reports]


def report_on(series, reference):
    """One series by itself: everything but its ratio to the best."""
    scores = score_series(series, reference)
    points = tuple(point_of(series, scores, point) for point in series.points)
    fit = fit_of(series.runs, scores)
    bias = None if series.name == reference.series else bias_of(series, reference)
    if doubt := doubt_of(bias, points, reference):
        bias = replace(bias, is_significant=False, doubt=doubt)
    flags = flags_of(points, fit, bias, reference)
    means = [mean_of([getattr(point, name) for point in points]) for name in ("efficiency", "efficiency_trimmed")]
    return SeriesReport(series.name, series.runs, scores, points, fit, *means, None, None, bias, flags)


def point_of(series, scores, point):
    """The repeats of one budget."""
    chosen = series.at(point)
    runs, found = [series.runs[index] for index in chosen], [scores[index] for index in chosen]
    column = {name: np.array([getattr(entry, name) for entry in found]) for name in ("mse", "relmse", "relmse_trimmed", "largest_share", "reference_relmse")}
    bands = {}
    for name, label in (("mse", "mse"), ("relmse", "relmse"), ("relmse_trimmed", "trimmed")):
        low, middle, high = np.percentile(column[name], BAND_PERCENT)
        bands |= {f"{label}_mean": float(column[name].mean()), f"{label}_median": float(middle), f"{label}_10": float(low), f"{label}_90": float(high)}
    stages = {name: mean_known(runs, name) for name in ("wall_s", "setup_cpu_s", "load_cpu_s", "pilot_cpu_s", "bootstrap_cpu_s", "render_cpu_s")}
    raw = column["relmse"] + column["reference_relmse"]
    relmse, cpu_s = bands["relmse_mean"], float(np.mean([run.cpu_s for run in runs]))
    made = Point(
        series=series.name, point=point, repeats=len(runs), spp=runs[0].spp, cpu_s=cpu_s, **stages,
        cpu_s_median=float(np.median([run.cpu_s for run in runs])), **bands,
        largest_share=float(np.median(column["largest_share"])),
        worst_repeat_share=float(raw.max() / raw.sum()) if raw.sum() > 0 else 0.0,
        reference_share=float(column["reference_relmse"].mean() / relmse) if relmse > 0 else np.inf,
        efficiency=inverse(relmse * cpu_s), efficiency_trimmed=inverse(bands["trimmed_mean"] * cpu_s),
    )
    return replace(made, flags=tuple(point_flags(made)))


def mean_known(runs, name):
    """The mean of what runs say of something; None where one does not."""
    values = [getattr(run, name) for run in runs]
    return None if None in values else float(np.mean(values))


def inverse(value):
    """1 / value, or None where it is not above zero."""
    return float(1 / value) if value > 0 else None


def is_heavy(point):
    """Whether an error is that of a few pixels, or of one repeat (of three or more)."""
    return point.largest_share > HEAVY_SHARE or (point.repeats > 2 and point.worst_repeat_share > HEAVY_SHARE)


def point_flags(point):
    """Names of the flags of one point."""
    if is_heavy(point):
        yield "heavy tail"
    if not point.relmse_mean > 0:
        yield "error not above zero"
    if point.reference_share > REFERENCE_SHARE:
        yield "reference floor"


def flags_of(points, fit, bias, reference):
    """The flags of a series, with the figures that raised them."""
    flags = []
    heavy = [point for point in points if is_heavy(point)]
    if heavy:
        pixels, repeat = max(point.largest_share for point in heavy), max(point.worst_repeat_share for point in heavy)
        flags.append(Flag("heavy tail", f"at {len(heavy)} of {len(points)} points: the largest 0.1 % of pixels hold up to {pixels:.0%} of the error, one repeat up to {repeat:.0%} of its point's"))
    if bias is not None and bias.is_significant:
        share = bias.squared.value / points[-1].relmse_mean if points[-1].relmse_mean > 0 else np.inf
        words = f"mean over reference {bias.mean_ratio.value:.4f} [{bias.mean_ratio.low:.4f}, {bias.mean_ratio.high:.4f}], squared bias {bias.squared.value:.2e}, {min(share, 1):.0%} of the last point's relMSE, z {bias.z:.1f} (limit {bias.limit:.1f})"
        flags.append(Flag("bias floor", words) if reference.series is None else Flag("disagreement", f"differs from `{reference.series}`: one of the two misses light: {words}"))
    fewest = min(point.repeats for point in points)
    if fewest < FEWEST_REPEATS:
        flags.append(Flag("few repeats", f"a point has {fewest}: " + ("intervals are hardly known" if fewest > 1 else "there are no intervals")))
    if reference.variance is None:
        flags.append(Flag("reference noise unknown", FLAGS["reference noise unknown"]))
    floored = [point for point in points if "reference floor" in point.flags]
    if floored:
        flags.append(Flag("reference floor", f"at {len(floored)} of {len(points)} points: the reference's own error is up to {max(point.reference_share for point in floored):.2f} of that plotted"))
    if any("error not above zero" in point.flags for point in points):
        flags.append(Flag("error not above zero", FLAGS["error not above zero"]))
    slope = fit.relmse_render or fit.relmse
    if slope is not None and slope.low > FLATTEST:
        flags.append(Flag("flat slope", f"{slope.value:.2f} [{slope.low:.2f}, {slope.high:.2f}]: infinite variance, bias or the reference's noise"))
    if slope is not None and slope.high < STEEPEST:
        flags.append(Flag("steep slope", f"{slope.value:.2f} [{slope.low:.2f}, {slope.high:.2f}]"))
    return tuple(flags)


def ratios(reports):
    """The reports with their ratios to the best efficiency."""
    for name, field in (("relmse", "ratio_to_best"), ("relmse_trimmed", "ratio_to_best_trimmed")):
        key = "efficiency" if name == "relmse" else "efficiency_trimmed"
        able = [report for report in reports if getattr(report, key) is not None]
        if not able:
            continue
        best = max(able, key=lambda report: getattr(report, key))
        reports = [replace(report, **{field: ratio_to(report, best, name)}) for report in reports]
    return reports
