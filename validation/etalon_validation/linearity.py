"""Whether a photograph's noise is that of linear values.

Where a sensor counts photons, the noise of linear values grows as the square root of the level. Values raised to
a power gamma have noise in proportion to level^e with e = 1 - 1 / (2 gamma) (first order), so the noise of flat
areas tells the power without any knowledge of the scene. Processing that takes noise away unevenly (sharpening,
adaptive filters) misleads it.
"""

import numpy as np
from scipy.ndimage import uniform_filter
from scipy.signal import convolve2d

# Second differences along both axes, scaled so that white noise keeps its deviation; planes vanish.
KERNEL = np.outer([1, -2, 1], [1, -2, 1]) / 6
# Levels between these are far from the black level and from clipping.
LEVELS = (0.15, 0.85)
BINS = 8
# Steeper places than this, per pixel, are edges.
FLAT = 0.01
LEAST_PIXELS = 300
# Median absolute value of a unit normal deviate.
MEDIAN_OF_NORMAL = 0.6744897501960817
DRAWS = 200
SEED = 5


def noise_exponent(rgb, inside):
    """The exponent e of noise against level over the pixels `inside`, with its 95 % interval; None where levels do not spread.

    Medians of tiles are resampled, so that an area of texture counts once.
    """
    samples = [channel_samples(rgb[..., channel], inside) for channel in range(3)]
    levels = [np.concatenate(part) for part in zip(*samples)]
    if len(levels[0]) < LEAST_PIXELS:
        return None
    generator = np.random.default_rng(SEED)
    best = slope(*levels)
    draws = []
    for _ in range(DRAWS):
        chosen = generator.integers(len(levels[0]), size=len(levels[0]))
        draws.append(slope(*(part[chosen] for part in levels)))
    draws = [draw for draw in draws if draw is not None]
    if best is None or len(draws) < DRAWS // 2:
        return None
    low, high = np.percentile(draws, (2.5, 97.5))
    return {"exponent": round(best, 3), "interval_95": [round(float(low), 3), round(float(high), 3)], "linear_would_be": 0.5, "tone_exponent": round(1 / (2 * (1 - best)), 3), "tiles": len(levels[0])}


def in_words(file, noise):
    """What the exponent says of a file, and whether it speaks against linear values."""
    low, high = noise["interval_95"]
    if low <= noise["linear_would_be"] <= high:
        return f"The noise of {file} grows as that of linear values (exponent {noise['exponent']:.2f}).", False
    return (
        f"The noise of {file} grows with exponent {noise['exponent']:.2f} ({low:.2f} to {high:.2f}) of the level, where linear values have 0.5: "
        f"these are not linear values, unless processing took noise away by level. A tone exponent of {noise['tone_exponent']:.2f} would give it."
    ), True


def channel_samples(values, inside, tile=5):
    """Mean level and noise deviation of flat tiles of a channel."""
    noise = np.abs(convolve2d(values, KERNEL, mode="same"))
    smooth = uniform_filter(values, 3)
    steep = np.hypot(*np.gradient(smooth)) > FLAT
    good = inside & ~steep
    rows, columns = (size // tile * tile for size in values.shape)

    def tiles(array):
        return array[:rows, :columns].reshape(rows // tile, tile, columns // tile, tile).swapaxes(1, 2).reshape(-1, tile * tile)

    whole = tiles(good).all(axis=1)
    return tiles(values)[whole].mean(axis=1), np.median(tiles(noise)[whole], axis=1) / MEDIAN_OF_NORMAL


def slope(level, noise):
    """Slope of log noise against log level through the medians of bins; None with fewer than three bins."""
    edges = np.geomspace(*LEVELS, BINS + 1)
    points = []
    for low, high in zip(edges, edges[1:]):
        within = (level >= low) & (level < high)
        if within.sum() >= 20:
            points.append((np.log(level[within]).mean(), np.log(np.median(noise[within]))))
    if len(points) < 3 or not np.isfinite(points).all():
        return None
    return float(np.polyfit(*np.array(points).T, 1)[0])
