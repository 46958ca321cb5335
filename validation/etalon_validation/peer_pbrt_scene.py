"""A scene as pbrt reads it: the text of a scene file of its fourth version.

Shapes keep their kinds, lengths the scene's unit, and spectra their tables. A
lamp's spectrum is normalised by the renderer to 1 cd/m2 and multiplied by
`scale`, the luminance that Etalon's observer gives it, so that the film's
luminance is absolute and no factor is fitted. The renderer's camera is
left-handed, ours is not: its first axis is turned round before anything else.
"""

import numpy as np

from .peer_scene import EFFICACY, Diffuse, Faces, Glass, Metal, Sphere, Disk

# Beyond the wavelengths that are rendered; tables that go on have their ends here.
FIRST_NM, LAST_NM = 300.0, 900.0


def scene_text(order, integrator, film):
    """The scene file of an `Order`, with the line of its integrator; the film goes to the file `film`."""
    width, height = order.scene.camera.resolution
    camera, half = order.scene.camera, height / width
    lines = [
        f'{integrator}',
        f'Sampler "zsobol" "integer pixelsamples" [ {order.spp} ] "integer seed" [ {order.seed} ]',
        'PixelFilter "box" "float xradius" [ 0.5 ] "float yradius" [ 0.5 ]',
        f'Film "rgb" "integer xresolution" [ {width} ] "integer yresolution" [ {height} ] "string filename" [ "{film}" ] "string sensor" [ "cie1931" ] "float iso" [ 100 ]',
        "Scale -1 1 1",
        f"LookAt {numbers([*camera.position, *camera.target, *camera.up])}",
        f'Camera "perspective" "float fov" [ {camera.fov_x_deg:.9g} ] "float screenwindow" [ -1 1 {-half:.9g} {half:.9g} ]',
        "WorldBegin",
    ]
    for thing in order.scene.things:
        lines += ["AttributeBegin", *lamp(thing.radiance, order.observer), material(thing.material), *shape(thing.shape), "AttributeEnd"]
    return "\n".join(lines) + "\n"


def numbers(values):
    """Numbers of a list or table in their order."""
    return " ".join(f"{value:.9g}" for value in np.ravel(values))


def spectrum(table):
    """Pairs of wavelength and value; beyond them the renderer takes zero."""
    nm, values = np.array(table.nm), np.array(table.values)
    if table.holds:
        inside = (nm > FIRST_NM) & (nm < LAST_NM)
        nm = np.concatenate([[FIRST_NM], nm[inside], [LAST_NM]])
        values = table.at(nm)
    return numbers(np.stack([nm, values], axis=1))


def lamp(radiance, observer):
    """The line of a lamp, if it is one."""
    if radiance is None:
        return []
    luminance = EFFICACY * float(np.trapezoid(radiance.at(observer[:, 0]) * observer[:, 2], observer[:, 0]))
    return [f'AreaLightSource "diffuse" "spectrum L" [ {spectrum(radiance)} ] "float scale" [ {luminance:.9g} ]']


def material(described):
    """The line of a material; a mirror reflects as a metal of its reflectance at normal incidence."""
    if isinstance(described, Glass):
        return f'Material "dielectric" "float eta" [ {described.index:.9g} ] "float roughness" [ 0 ]'
    if isinstance(described, Metal):
        return f'Material "conductor" "spectrum eta" [ {spectrum(described.n)} ] "spectrum k" [ {spectrum(described.k)} ] "float roughness" [ 0 ]'
    reflectance = f'"spectrum reflectance" [ {spectrum(described.reflectance)} ]'
    if isinstance(described, Diffuse):
        return f'Material "diffuse" {reflectance}'
    return f'Material "conductor" {reflectance} "float roughness" [ 0 ]'


def shape(described):
    """The lines of a shape, one for each part."""
    if isinstance(described, Faces):
        return faces(described)
    if isinstance(described, Sphere):
        return [f"Translate {numbers(described.center)}", f'Shape "sphere" "float radius" [ {described.radius:.9g} ]']
    if isinstance(described, Disk):
        return [disk(described.center, described.normal, described.radius)]
    start, end = np.array(described.start), np.array(described.end)
    length = float(np.linalg.norm(end - start))
    side = f'Shape "cylinder" "float radius" [ {described.radius:.9g} ] "float zmin" [ 0 ] "float zmax" [ {length:.9g} ]'
    return [placed(start, end - start, side), disk(start, start - end, described.radius), disk(end, end - start, described.radius)]


def faces(described):
    """Quadrangles as patches, which pbrt samples as a whole where they shine, and the rest as triangles."""
    quads = [face for face in described.faces if len(face) == 4]
    fans = [(face[0], *pair) for face in described.faces if len(face) != 4 for pair in zip(face[1:], face[2:])]
    points = f'"point3 P" [ {numbers(described.vertices)} ]'
    lines = []
    if quads:
        # A patch's third corner is beside its first one.
        order = [(a, b, d, c) for a, b, c, d in quads]
        lines.append(f'Shape "bilinearmesh" {points} "integer indices" [ {numbers(order)} ]')
    if fans:
        lines.append(f'Shape "trianglemesh" {points} "integer indices" [ {numbers(fans)} ]')
    return lines


def disk(center, normal, radius):
    """A disk that faces along `normal`."""
    return placed(center, normal, f'Shape "disk" "float radius" [ {radius:.9g} ]')


def placed(origin, axis, line):
    """A shape whose third axis runs along `axis` from `origin`."""
    axis = np.array(axis, float) / np.linalg.norm(axis)
    first = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    first /= np.linalg.norm(first)
    columns = [*first, 0, *np.cross(axis, first), 0, *axis, 0, *origin, 1]
    return f"AttributeBegin\nConcatTransform [ {numbers(columns)} ]\n{line}\nAttributeEnd"
