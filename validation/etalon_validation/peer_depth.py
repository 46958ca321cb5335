"""Where peers that have no roulette end their bidirectional paths.

Cost grows with this number, up to its square, so a peer is given the fewest
reflections that leave out less than 1 % of the picture, the margin for its
mean: found with `etalon render --integrator bdpt --max-bounces N` against the
same with 64, among 6, 8, 10, 12, 16 and 20. A scene that is not listed gets the default, which
is enough in closed rooms whose light comes from lamps in view.
"""

DEFAULT = 16
# With the share that each leaves out (36x36 pixels or as the sensor's shape, 48 samples, equal seeds).
BOUNCES = {
    "cornell": 6,  # 0.7 %
    "cornell-ccd": 8,  # 0.6 %
    "cornell-photo": 8,  # 0.6 %
    "schoedl-2007": 8,  # 0.5 %
    "schoedl-2007-small-bulb": 8,  # 0.6 %
    "door-ajar": 12,  # 0.4 %
    "slit-room": 20,  # 0.8 %
}


def bounces(scene):
    """Reflections after which paths end."""
    return BOUNCES.get(scene.name, DEFAULT)
