"""Where peers that have no roulette end their bidirectional paths.

Cost grows with this number, up to its square, so a peer is given the fewest
reflections that leave out less than 0.4 % of the picture: dark corners lose up
to ten times that share, and 3 % of a block is what a right picture may be off.
Found with `etalon render --integrator bdpt --max-bounces N` against the same
with 64, among 6, 8, 10, 12, 16, 20 and 24. A scene that is not listed gets the
default, which is enough in closed rooms whose light comes from lamps in view.
"""

DEFAULT = 16
# With the share that each leaves out (36 pixels along the longer side, 48 samples, equal seeds).
BOUNCES = {
    "cornell": 8,  # 0.17 %
    "cornell-ccd": 10,  # 0.17 %
    "cornell-photo": 10,  # 0.17 %
    "schoedl-2007": 10,  # 0.21 %
    "schoedl-2007-small-bulb": 10,  # 0.26 %
    "door-ajar": 12,  # 0.39 %
    "slit-room": 24,  # 0.38 %
}


def bounces(scene):
    """Reflections after which paths end."""
    return BOUNCES.get(scene.name, DEFAULT)
