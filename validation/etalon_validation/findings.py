"""What the data settle and what they do not, in sentences made from the figures.

A fit always succeeds. Each sentence therefore holds what a level removed
against how well that quantity was known beforehand, and says which conclusion
the numbers leave open.
"""

import numpy as np

from .verdict import COVERAGE

# A declared standard uncertainty at which a pattern that no level removes is worth a sentence.
WORTH_A_SENTENCE = 0.05


def findings(levels, calibration, picture):
    """List of {topic, settled, text}; `levels` as in the report."""
    found = [exposure(levels, calibration), *colour(levels, calibration), veil(levels), *unremoved(calibration), largest(levels), counts(levels)]
    if not picture["available"]:
        found.append(finding("picture", False, f"Whole-picture figures are absent: {picture['reason']}."))
    return found


def finding(topic, settled, text):
    """One entry of the report's `findings`."""
    return {"topic": topic, "settled": bool(settled), "text": text}


def percent(value):
    """A share as a percentage of two digits."""
    return f"{float(f'{100 * value:.2g}'):g} %"


def known_to(u):
    """A relative standard uncertainty in words; as a factor where a percentage would mislead."""
    return percent(u) if u < 0.25 else f"a factor of {np.exp(u):.2g}"


def calibration_error(levels, calibration):
    """The exposure fitted at L1, which is the error of the calibration as a whole, beside how well that was known."""
    fitted = levels["L1"]["fitted"]
    declared = any(component.pattern == "level" for component in calibration.components)
    known = calibration.find("level") / np.log(2) if declared else None
    return {
        "exposure_stops": fitted["exposure_stops"], "exposure_stops_95": fitted["exposure_stops_95"],
        "exposure_factor": fitted["exposure_factor"], "declared_u_stops": None if known is None else round(known, 4),
        "within_declared": None if known is None else bool(abs(fitted["exposure_stops"]) <= COVERAGE * np.hypot(known, fit_u(fitted))),
    }


def listed(names):
    """Names joined as in a sentence."""
    return names[0] if len(names) == 1 else ", ".join(names[:-1]) + " and " + names[-1] if names else ""


def exposure(levels, calibration):
    """L1's exposure against what was known of lamp and exposure."""
    fitted = levels["L1"]["fitted"]
    stops, ends = fitted["exposure_stops"], fitted["exposure_stops_95"]
    removed = f"L1 removes {stops:+.2f} stops (95 %: {ends[0]:+.2f} to {ends[1]:+.2f})"
    parts = [component for component in calibration.components if component.pattern == "level"]
    if not parts:
        return finding("exposure", False, f"{removed}; no uncertainty of lamp level and exposure is declared, so that whether this is an error of the calibration or of the render is not settled.")
    known = calibration.find("level") / np.log(2)
    names = listed([f"{component.name} ({known_to(component.u)})" for component in parts])
    total = np.hypot(known, fit_u(fitted))
    against = f"{removed}. Known beforehand, as a standard uncertainty: {names}, together {known:.2f} stops"
    if abs(stops) <= COVERAGE * total:
        return finding("exposure", False, f"{against}. The difference is within it: it shows no error of the render, nor that there is none.")
    return finding("exposure", True, f"{against}. The difference is outside it, at {abs(stops) / total:.1f} u: scene, render or the declared calibration is wrong.")


def fit_u(fitted):
    """Standard uncertainty in stops of the fitted exposure."""
    low, high = fitted["exposure_stops_95"]
    return (high - low) / 2 / COVERAGE


def colour(levels, calibration):
    """Whether chromaticity is evidence below the level that fits a matrix, and luminance across a tone curve."""
    mixture, tone = calibration.find("mixture"), calibration.find("tone")
    if mixture:
        row = next(row for row in levels["L2"]["budget"] if row["pattern"] == "mixture")
        seen = levels["L2"]["overall"]["mean_duv"]
        yield finding("colour", False, f"The photograph's colour transform is known to mixtures of {percent(mixture)} between channels, which is u'v' {row['duv_u']:.4f} (standard, median); the mean distance at L2 is {seen:.4f}: chromaticity differences at L0 to L2 of that order are not evidence against the render.")
    if tone:
        row = next(row for row in levels["L1"]["budget"] if row["pattern"] == "tone")
        yield finding("tone", False, f"The photograph's tone curve is known to {percent(tone)} in its exponent, which leaves {percent(row['luminance_u'])} in luminance at L1 (standard, median) and {percent(row['luminance_u_largest'])} at most: smaller ratios of dark to bright regions are not evidence.")


def veil(levels):
    """What the fitted glare shows."""
    fitted = levels["L4"]["fitted"]
    share, (low, high) = fitted["glare_share"], fitted["glare_share_95"]
    if None in (share, low, high):
        return finding("glare", False, "L4 finds no veiling glare to speak of: the fit is not determined.")
    said = f"L4 fits veiling glare of {percent(share)} of the light (95 %: {percent(low)} to {percent(high)})"
    if fitted["glare_at_limit"]:
        return finding("glare", False, f"{said}, the end of its search: the photograph does not differ from the render by a uniform veil.")
    if low <= 0 <= high:
        return finding("glare", False, f"{said}: none is shown, and none above {percent(high)} is possible if nothing else differs.")
    if share < 0:
        return finding("glare", False, f"{said}: less light in the dark than the render has is no glare. A black level taken off, or a tone curve with more contrast, would look so.")
    return finding("glare", False, f"{said}: a veil would explain lighter dark regions; so would a tone curve with less contrast or a black level left in, and this photograph cannot tell them apart.")


def unremoved(calibration):
    """Components that no level takes up."""
    for component in calibration.components:
        if component.removed_by is None and component.pattern != "tone" and component.u >= WORTH_A_SENTENCE:
            across = {"surfaces": "between surfaces", "regions": "between regions", "vignetting": "between middle and corner"}[component.pattern]
            yield finding("calibration", False, f"{component.name[:1].upper()}{component.name[1:]} ({known_to(component.u)}, standard; {component.source}) is removed by no level: differences {across} below {known_to(COVERAGE * component.u)} are not evidence against the render.")


def largest(levels):
    """The component that a better measurement would have to lower first."""
    rows = [row for row in levels["L1"]["budget"] if row["kind"] and row["luminance_u"] is not None]
    row = max(rows, key=lambda row: row["luminance_u"])
    more = " More samples per pixel lower it." if row["component"] == "render noise" else ""
    return finding("budget", True, f"At L1 the largest part of the luminance budget is {row['component']}: {percent(row['luminance_u'])} (standard, median over regions).{more}")


def counts(levels):
    """Verdicts of all levels in one sentence."""
    said = []
    for name, level in levels.items():
        row = level["verdict"]
        said.append(f"{name}: {row['differ']} differ, {row['agree']} agree, {row['unsettled']} cannot be settled")
    first = levels["L0"]["verdict"]
    return finding("verdict", True, f"Regions, by level. {'; '.join(said)}. At most {percent(first['false_alarms'])} of the regions called different are expected to be false alarms ({first['correction']}).")
