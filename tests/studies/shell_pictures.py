"""Panels of deformed shells for the pictures of the studies, drawn from a run's results.vtkhdf by the parts of driver/plot."""
import sys

import matplotlib
import numpy

matplotlib.use("Agg")
from matplotlib.collections import PolyCollection

import common

sys.path.insert(0, str(common.root / "driver"))
import plot


def results(folder):
    return plot.Results(folder / "results.vtkhdf")


def panel(axes, found, step, field, norm, view, keep=None, bodies=(1, 2), cmap="turbo", shift=None, fine=4):
    """Elements of some bodies, those of which `keep` says so of the middle at rest (n,3), seen from `view` (degrees): coloured
    by a field (None: bare). `shift` moves a body's picture: {body: (x, y, z)}."""
    number = int(numpy.flatnonzero(found.steps == step)[0])
    look = plot.camera(view)
    a = numpy.linspace(0, 1, fine + 1)
    middle = (a[1:] + a[:-1]) / 2
    centre = numpy.array([0.5])
    value_of = found.source(field)[1] if field else None
    polygons, colours, depths, rims = [], [], [], []
    for group in plot.faces_of(found, number, field or "none", 1.0):
        chosen = numpy.isin(group.body, bodies)
        if keep is not None:
            chosen &= keep(group.evaluate(group.rest, centre, centre)[:, 0, 0])
        group = group.take(chosen)
        if not len(group.w):
            continue
        moved = numpy.array([(shift or {}).get(int(b), (0, 0, 0)) for b in group.body])[:, None, None]
        places = (group.evaluate(group.place, a, a) + moved) @ look.T
        quads = numpy.stack([places[:, :-1, :-1], places[:, :-1, 1:], places[:, 1:, 1:], places[:, 1:, :-1]], axis=-2)
        quads = quads.reshape(-1, 4, 3)
        normal = numpy.cross(quads[:, 2] - quads[:, 0], quads[:, 3] - quads[:, 1])
        normal /= numpy.maximum(numpy.linalg.norm(normal, axis=1), 1e-300)[:, None]
        shade = 0.72 + 0.28 * numpy.abs(normal @ numpy.array([-0.35, 0.45, 0.82]))
        if field:
            rgba = matplotlib.colormaps[cmap](norm(value_of(group.evaluate(group.field, middle, middle)).ravel()))
        else:
            rgba = numpy.tile(matplotlib.colors.to_rgba("#b8cbdc"), (len(quads), 1))
        rgba[:, :3] *= shade[:, None]
        polygons.append(quads[..., :2])
        colours.append(rgba)
        depths.append(quads[..., 2].mean(axis=1))
        edge = numpy.concatenate([places[:, 0], places[:, :, -1], places[:, -1, ::-1], places[:, ::-1, 0]], axis=1)
        rims.append((edge[..., :2], edge[..., 2].mean(axis=1)))
    polygons, colours, depths = (numpy.concatenate(parts) for parts in (polygons, colours, depths))
    lines = [line for part, _ in rims for line in part]
    heights = numpy.concatenate([depth for _, depth in rims])
    extent = numpy.ptp(polygons.reshape(-1, 2), axis=0).max()
    order = numpy.argsort(numpy.concatenate([depths, heights + 0.015 * extent]))
    shapes = list(polygons) + lines
    faces = numpy.concatenate([colours, numpy.zeros((len(lines), 4))])
    edges = numpy.concatenate([colours, numpy.tile((0, 0, 0, 0.3), (len(lines), 1))])
    axes.add_collection(PolyCollection([shapes[i] for i in order], facecolors=faces[order], edgecolors=edges[order],
                                       linewidths=0.2, rasterized=True))
    axes.autoscale_view()
    axes.set_aspect("equal")
    axes.axis("off")
