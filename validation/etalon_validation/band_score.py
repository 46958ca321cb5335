"""Scores a render band by band against narrow-band images.

The images are in units of their own, so that there is no level at which nothing
is fitted. L1 fits one factor to all counted bands together: what is left is the
error of the spectra and of the light's distribution. L2 fits one factor per
band: what is left is the distribution alone, and the scatter of the factors is
the error of the spectral chain.
"""

from dataclasses import dataclass

import numpy as np
from scipy import stats

from .errors import InputError
from .polygons import mask
from .regions import CORRELATED_PIXELS

# A region darker than this share of the band's brightest one shows black level and flare, not the scene.
DARK_SHARE = 0.01
# Draws of surfaces behind the interval of a band's factor, and their seed.
DRAWS = 1000
SEED = 20070711
# Half width of a 95 % interval in standard errors.
Z95 = stats.norm.ppf(0.975)


@dataclass(frozen=True)
class Measured:
    """Means of regions (regions, bands) and their relative standard errors."""

    mean: np.ndarray
    relative: np.ndarray
    pixels: np.ndarray


def measure_images(images, pairs):
    """Region means of the band images; neighbouring pixels are not independent."""
    where = [mask(pair.in_bands, images.size) for pair in pairs]
    mean = np.array([[band[inside].mean() for band in images.values] for inside in where])
    spread = np.array([[band[inside].std(ddof=1) for band in images.values] for inside in where])
    pixels = np.array([inside.sum() for inside in where])
    error = spread * np.sqrt(np.minimum(1, CORRELATED_PIXELS / pixels))[:, None]
    return Measured(mean, error / np.maximum(np.abs(mean), 1e-30), pixels)


def measure_render(channels, luminance, deviation, pairs):
    """Region means of a render's band channels; their relative error is taken to be that of the luminance."""
    size = channels.shape[2], channels.shape[1]
    where = [mask(pair.in_render, size) for pair in pairs]
    mean = np.array([[band[inside].mean() for band in channels] for inside in where])
    relative = [np.sqrt((deviation[inside] ** 2).sum()) / max(luminance[inside].sum(), 1e-30) for inside in where]
    return Measured(mean, np.repeat(np.array(relative)[:, None], len(channels), axis=1), np.array([inside.sum() for inside in where]))


def usable(photo, render):
    """Which regions are bright enough in which bands (regions, bands)."""
    return (photo.mean > DARK_SHARE * photo.mean.max(axis=0)) & (photo.mean > 0) & (render.mean > 0)


def score_bands(bands, pairs, photo, render, place):
    """The levels of report.json: factors, and the ratio of every region in every band."""
    good = usable(photo, render)
    counted = np.array([band.counted for band in bands])
    for index, band in enumerate(bands):
        if band.counted and good[:, index].sum() < 4:
            raise InputError(place, f"{good[:, index].sum()} regions are bright enough at {band.nm} nm", "check that the bands are those of the box")
    with np.errstate(divide="ignore", invalid="ignore"):
        stops = np.where(good, np.log2(photo.mean / render.mean), np.nan)
    surfaces = np.array([pair.surface for pair in pairs])
    one = float(np.nanmean(np.where(counted[None], stops, np.nan)))
    each = np.array([np.nanmean(column) if np.isfinite(column).any() else np.nan for column in stops.T])
    ends = [interval_over_surfaces(column, surfaces) for column in stops.T]
    relative = np.hypot(photo.relative, render.relative)
    names = {"L1": "one factor for all counted bands", "L2": "one factor per band"}
    fitted = {"L1": np.full(len(bands), one), "L2": each}
    levels = {
        name: level(names[name], fitted[name], bands, pairs, stops, relative, counted, photo, render) for name in names
    }
    levels["L1"]["fitted"] = {"log2_factor": number(one), "interval_95": over_bands(each[counted])}
    levels["L2"]["fitted"] = {
        str(band.nm): {"log2_factor": number(each[i]), "interval_95": ends[i], "stops_from_common": number(each[i] - one)} for i, band in enumerate(bands)
    }
    return levels


def level(title, factors, bands, pairs, stops, relative, counted, photo, render):
    """One level: rms of every band, overall figures of the counted ones, and all regions."""
    left = factors[None] - stops
    rows = []
    for index, pair in enumerate(pairs):
        cells = [cell(left[index, i], relative[index, i], photo.mean[index, i], render.mean[index, i]) for i in range(len(bands))]
        rows.append({"name": pair.name, "surface": pair.surface, "pixels": int(photo.pixels[index]), "bands": {str(band.nm): value for band, value in zip(bands, cells)}})
    inside = left[:, counted]
    return {
        "title": title,
        "bands": {str(band.nm): {"rms_stops": rms(left[:, i]), "count": int(np.isfinite(left[:, i]).sum()), "counted": band.counted} for i, band in enumerate(bands)},
        "overall": {"rms_stops": rms(inside), "count": int(np.isfinite(inside).any(axis=1).sum())},
        "regions": rows,
    }


def cell(stops, relative, photo, render):
    """The figures of one region in one band; the ratio is None where one side is too dark."""
    if not np.isfinite(stops):
        return {"ratio": None, "ratio_95": None, "photo": number(photo), "render": number(render)}
    ratio, reach = 2.0**stops, np.exp(Z95 * relative)
    return {"ratio": number(ratio), "ratio_95": [number(ratio / reach), number(ratio * reach)], "photo": number(photo), "render": number(render)}


def interval_over_surfaces(column, surfaces):
    """95 % interval of a band's log2 factor: whole surfaces drawn with replacement, for regions of one share their error."""
    names = np.unique(surfaces[np.isfinite(column)])
    if len(names) < 2:
        return None
    sums = np.array([np.nansum(column[surfaces == name]) for name in names])
    counts = np.array([np.isfinite(column[surfaces == name]).sum() for name in names])
    drawn = np.random.default_rng(SEED).integers(0, len(names), (DRAWS, len(names)))
    means = sums[drawn].sum(axis=1) / counts[drawn].sum(axis=1)
    return [number(end) for end in np.percentile(means, (2.5, 97.5))]


def over_bands(factors):
    """95 % interval of the common log2 factor from the scatter of the bands' own (Student's t)."""
    if len(factors) < 2:
        return None
    reach = stats.t.ppf(0.975, len(factors) - 1) * factors.std(ddof=1) / np.sqrt(len(factors))
    return [number(factors.mean() - reach), number(factors.mean() + reach)]


def rms(values):
    """Root mean square of the finite values, or None."""
    finite = values[np.isfinite(values)]
    return number(np.sqrt((finite**2).mean())) if len(finite) else None


def number(value):
    """A finite number with six significant digits for JSON, or None."""
    return float(f"{float(value):.6g}") if np.isfinite(value) else None
