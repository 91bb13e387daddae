"""Pictures of a result folder: the curves of history.csv and the deformed mesh of results.vtkhdf.

Elements are drawn as what they are: rational Bezier patches, evaluated from their control points and weights. Bodies
of three dimensions show their outer faces, seen from --view.
"""
import argparse
import csv
import re
import sys
from math import comb
from pathlib import Path

try:
    import matplotlib
    matplotlib.use('Agg')
    import matplotlib.pyplot as plt
    import numpy as np
    from matplotlib.collections import LineCollection, PolyCollection
    from matplotlib.colors import Normalize, TwoSlopeNorm
except ImportError as missing:
    sys.exit(f'plot: {missing}. driver/plot installs what it needs; call that.')

TENSOR = {'xx': 0, 'yy': 1, 'zz': 2, 'xy': 3, 'yz': 4, 'xz': 5}
VECTOR = {'x': 0, 'y': 1, 'z': 2}
MOST_POLYGONS = 200_000
FIRST_COLUMNS = ['step', 'time', 'iterations', 'cutbacks', 'active']
ENERGIES = ['work', 'elastic', 'dissipated', 'penalty_energy']
KINDS = {'r': 'reaction', 'u': 'displacement'}

plt.rcParams.update({'font.size': 10, 'axes.grid': True, 'grid.alpha': 0.3, 'axes.spines.top': False,
                     'axes.spines.right': False, 'figure.dpi': 100, 'savefig.bbox': 'tight'})


class Trouble(Exception):
    """What the user should know, and the exit status."""

    def __init__(self, text, status):
        super().__init__(text)
        self.status = status


# ---------------------------------------------------------------- curves

def read_history(path):
    with open(path, newline='') as file:
        rows = list(csv.reader(file))
    if not rows or rows[0][:5] != FIRST_COLUMNS:
        raise Trouble(f'{path} is no history of bezel', 3)
    names = rows[0]
    data = np.array([[float(item) for item in row] for row in rows[1:] if len(row) == len(names)])
    return {name: data[:, k] if len(data) else np.zeros(0) for k, name in enumerate(names)}


def panels_of(names):
    """Columns that belong into one panel: (title, [(column, legend)])."""
    panels = {}
    for name in names:
        if name in FIRST_COLUMNS:
            continue
        if name in ENERGIES:
            panels.setdefault('energy', []).append((name, name.replace('_', ' ')))
            continue
        match = re.fullmatch(r'(.+)_([ru])([xyz])', name)
        if match:
            label, kind, axis = match.groups()
            panels.setdefault(f'{label}: {KINDS[kind]}', []).append((name, axis))
        else:
            panels.setdefault(name.replace('_', ' '), []).append((name, ''))
    panels['solution'] = [('iterations', 'iterations'), ('cutbacks', 'cut-backs')]
    panels['active interface points'] = [('active', '')]
    return list(panels.items())


def plot_history(data, title, path):
    panels = panels_of(data)
    if not data['active'].any():
        panels.pop()
    columns = 1 if len(panels) == 1 else 2
    rows = -(-len(panels) // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(6 * columns, 3.2 * rows), squeeze=False, sharex=True)
    for ax, (name, curves) in zip(axes.flat, panels):
        for column, legend in curves:
            ax.plot(data['time'], data[column], label=legend, linewidth=1.4,
                    marker='.' if len(data['time']) < 30 else None)
        ax.set_title(name, loc='left', fontsize=10, fontweight='bold')
        ax.tick_params(labelbottom=True)
        if any(legend for _, legend in curves):
            ax.legend(frameon=False)
    for ax in list(axes.flat)[len(panels):]:
        ax.remove()
    for ax in list(axes.flat)[max(0, len(panels) - columns):len(panels)]:
        ax.set_xlabel('time')
    figure.suptitle(title)
    figure.tight_layout()
    figure.savefig(path, dpi=130)
    plt.close(figure)


# ---------------------------------------------------------------- cells

def vtk_order(p, q, r):
    """Tensor index (first direction fastest) of each point of a cell in VTK's order."""
    points = []
    if q == 0:
        points = [(0, 0, 0), (p, 0, 0)] + [(i, 0, 0) for i in range(1, p)]
    else:
        def rim(k):
            return ([(i, 0, k) for i in range(1, p)] + [(p, j, k) for j in range(1, q)]
                    + [(i, q, k) for i in range(1, p)] + [(0, j, k) for j in range(1, q)])
        corners = [(0, 0), (p, 0), (p, q), (0, q)]
        inner = [(i, j) for j in range(1, q) for i in range(1, p)]
        if r == 0:
            points = [(i, j, 0) for i, j in corners] + rim(0) + [(i, j, 0) for i, j in inner]
        else:
            points = [(i, j, k) for k in (0, r) for i, j in corners] + rim(0) + rim(r)
            points += [(i, j, k) for i, j in corners for k in range(1, r)]
            points += [(i, j, k) for i in (0, p) for k in range(1, r) for j in range(1, q)]
            points += [(i, j, k) for j in (0, q) for k in range(1, r) for i in range(1, p)]
            points += [(i, j, k) for k in (0, r) for i, j in inner]
            points += [(i, j, k) for k in range(1, r) for i, j in inner]
    return np.array([i + (p + 1) * (j + (q + 1) * k) for i, j, k in points])


def bernstein(p, x):
    return np.array([comb(p, i) * x**i * (1 - x)**(p - i) for i in range(p + 1)]).T


class Results:
    """The mesh and the outputs of results.vtkhdf."""

    def __init__(self, path):
        try:
            import h5py
            self.file = h5py.File(path, 'r', locking=False)
            group = self.file['VTKHDF']
            self.steps = np.asarray(self.file['bezel/steps/step'])
            self.times = np.asarray(self.file['bezel/steps/time'])
            self.points = np.asarray(group['Points'])
            self.weights = np.asarray(group['PointData/RationalWeights'])
            self.degrees = np.asarray(group['CellData/HigherOrderDegrees']).astype(int)
            self.body = np.asarray(group['CellData/body'])
            self.offsets = np.asarray(group['Offsets'])
        except (OSError, KeyError) as error:
            raise Trouble(f'{path} cannot be read ({error}). Is it being written, or was the run killed?', 3)
        self.group = group
        self.fields = [name for name in group['PointData'] if name != 'RationalWeights']
        self.solid = bool((self.degrees[:, 2] > 0).any())
        rises = len(self.steps) > 0 and 'displacement' in self.fields and self.values('displacement', -1)[:, 2].any()
        self.ndm = 3 if self.solid or np.ptp(self.points[:, 2]) > 0 or rises else 2     # flat shells leave their plane

    def title(self):
        try:
            text = self.file['bezel/provenance/deck'][0].decode(errors='replace')
        except (KeyError, IndexError):
            return ''
        for line in text.splitlines():
            if line.strip().lower().startswith('feap'):
                return re.sub(r'^\s*feap[\s*]*', '', line, flags=re.IGNORECASE).split('!')[0].strip()
        return ''

    def values(self, name, number):
        start = int(self.group[f'Steps/PointDataOffsets/{name}'][number])
        return np.asarray(self.group[f'PointData/{name}'][start:start + len(self.points)])

    def known_fields(self):
        names = ['u', 'ux', 'uy'] + (['uz'] if self.ndm == 3 else [])
        for name in self.fields:
            if name == 'displacement':
                continue
            parts = self.group[f'PointData/{name}'].shape[1:]
            if parts == (6,):
                names += [f'{name}_{part}' for part in TENSOR] + [f'{name}_mises']
            elif parts == (3,):
                names += [f'{name}_{part}' for part in VECTOR]
            else:
                names.append(name)
        return names + ['none']

    def source(self, name):
        """The stored arrays of a field, and how it is computed from their values at a place."""
        if name in ('u', 'ux', 'uy', 'uz'):
            if name == 'u':
                return 'displacement', lambda f: np.linalg.norm(f, axis=-1)
            return 'displacement', lambda f: f[..., VECTOR[name[1]]]
        if name in self.fields and self.group[f'PointData/{name}'].ndim == 1:
            return name, lambda f: f[..., 0]
        base, _, part = name.rpartition('_')
        if base in self.fields:
            parts = self.group[f'PointData/{base}'].shape[1:]
            if parts == (6,) and part in TENSOR:
                return base, lambda f: f[..., TENSOR[part]]
            if parts == (6,) and part == 'mises':
                return base, lambda f: np.sqrt(np.maximum(0, 0.5 * (
                    (f[..., 0] - f[..., 1])**2 + (f[..., 1] - f[..., 2])**2 + (f[..., 2] - f[..., 0])**2
                    + 6 * (f[..., 3]**2 + f[..., 4]**2 + f[..., 5]**2))))
            if parts == (3,) and part in VECTOR:
                return base, lambda f: f[..., VECTOR[part]]
        raise Trouble(f'there is no field "{name}". Known fields: {", ".join(self.known_fields())}.', 2)


class Faces:
    """Rational Bezier faces of one pair of degrees: homogeneous coefficients (n, q+1, p+1, ...)."""

    def __init__(self, p, q, weights, place, rest, field, body, closed):
        self.p, self.q, self.w, self.place, self.rest = p, q, weights, place, rest
        self.field, self.body, self.closed = field, body, closed

    def evaluate(self, coefficients, a, b):
        """At the tensor grid of parameters a (first direction) and b."""
        ba, bb = bernstein(self.p, a), bernstein(self.q, b)
        w = np.einsum('nji,bj,ai->nba', self.w, bb, ba, optimize=True)
        f = np.einsum('nji,njid,bj,ai->nbad', self.w, coefficients, bb, ba, optimize=True)
        return f / w[..., None]

    def take(self, keep):
        return Faces(self.p, self.q, self.w[keep], self.place[keep], self.rest[keep],
                     None if self.field is None else self.field[keep], self.body[keep], self.closed)


def faces_of(results, number, field, scale):
    """All faces that may be seen: the elements themselves, or the sides of solids."""
    moved = results.points + scale * results.values('displacement', number)
    array = None
    if field != 'none':
        array = results.values(results.source(field)[0], number)
        array = array.reshape(len(array), -1)
    groups = []
    for degree in np.unique(results.degrees, axis=0):
        p, q, r = degree
        if q == 0:
            continue
        cells = np.flatnonzero((results.degrees == degree).all(axis=1))
        order = np.empty((p + 1) * (q + 1) * (r + 1), dtype=int)
        order[vtk_order(p, q, r)] = np.arange(len(order))
        ids = results.offsets[cells][:, None] + order
        ids = ids.reshape(len(cells), r + 1, q + 1, p + 1)
        body = results.body[cells]
        if r == 0:
            sides = [(p, q, ids[:, 0])]
        else:           # directed so that the normals point outward
            sides = [(q, p, ids[:, 0].transpose(0, 2, 1)), (p, q, ids[:, -1]),
                     (p, r, ids[:, :, 0]), (r, p, ids[:, :, -1].transpose(0, 2, 1)),
                     (r, q, ids[:, :, :, 0].transpose(0, 2, 1)), (q, r, ids[:, :, :, -1])]
        for a, b, index in sides:
            groups.append(Faces(a, b, results.weights[index], moved[index], results.points[index],
                                None if array is None else array[index], body, r > 0))
    if results.solid:
        groups = outer(groups)
    return [group for group in groups if len(group.w)]


def keys(points, body, size):
    """Rounded places that tell which sides and edges are the same one."""
    rounded = np.round(points / size * 1e6).astype(np.int64)
    return [(b, *row) for b, row in zip(body.tolist(), rounded.reshape(len(points), -1).tolist())]


def extent(groups):
    corners = np.concatenate([group.rest.reshape(-1, 3) for group in groups])
    return max(float(np.ptp(corners, axis=0).max()), 1e-300)


def outer(groups):
    """Faces of solids that no other element of the body shares."""
    size = extent(groups)
    centre = np.array([0.5])
    count, found = {}, []
    for group in groups:
        middle = group.evaluate(group.rest, centre, centre)[:, 0, 0]
        found.append(keys(middle, group.body, size))
        for key in found[-1]:
            count[key] = count.get(key, 0) + 1
    return [group.take(np.array([not group.closed or count[key] == 1 for key in names]))
            for group, names in zip(groups, found)]


def edges_of(group, fine):
    """The four edges of each face: (4n, points, 3) deformed, (4n, 3) middle at rest."""
    line, ends = np.linspace(0, 1, fine), np.array([0.0, 1.0])
    half = np.array([0.5])
    along = group.evaluate(group.place, line, ends)                          # n, 2, fine, 3
    across = group.evaluate(group.place, ends, line).transpose(0, 2, 1, 3)
    middle = np.concatenate([group.evaluate(group.rest, half, ends)[:, :, 0],
                             group.evaluate(group.rest, ends, half)[:, 0]], axis=1)
    return np.concatenate([along, across], axis=1).reshape(-1, fine, 3), middle.reshape(-1, 3)


def on_another(lines, bodies):
    """Which edges lie along another one of their body: those at T-junctions, where one element meets two."""
    if not lines:
        return np.zeros(0, dtype=bool)
    lines, bodies = np.array(lines), np.array(bodies)
    start, along = lines[:, :-1], np.diff(lines, axis=1)
    length = np.maximum((along**2).sum(-1), 1e-300)
    inside = np.zeros(len(lines), dtype=bool)
    for i, line in enumerate(lines):
        size = np.linalg.norm(np.diff(line, axis=0), axis=1).sum()
        for part in (0.26, 0.5, 0.74):   # one of them lies on the shorter neighbour, whichever edge is the longer one
            point = line[int(part * (len(line) - 1))]
            t = np.clip(((point - start) * along).sum(-1) / length, 0, 1)
            distance = np.linalg.norm(start + t[..., None] * along - point, axis=-1).min(axis=1)
            distance[i] = np.inf
            distance[bodies != bodies[i]] = np.inf
            inside[i] |= distance.min() < 2e-3 * size
    return inside


def camera(view):
    azimuth, elevation = np.radians(view)
    to_eye = np.array([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)])
    right = np.array([-np.sin(azimuth), np.cos(azimuth), 0])
    return np.array([right, np.cross(to_eye, right), to_eye])


def colour_range(values, limits):
    if limits:
        return Normalize(*limits), 'neither'
    values = values[np.isfinite(values)]
    if not len(values):
        return Normalize(0, 1), 'neither'
    low, high = np.percentile(values, [0.5, 99.5])
    if high - low <= 1e-12 * max(abs(low), abs(high), 1e-300):
        low, high = low - max(abs(low), 1e-30) * 1e-3, high + max(abs(high), 1e-30) * 1e-3
    extend = {(False, False): 'neither', (True, False): 'min', (False, True): 'max', (True, True): 'both'}[
        (bool(values.min() < low), bool(values.max() > high))]
    if low < 0 < high and min(-low, high) > 0.05 * max(-low, high):
        return TwoSlopeNorm(0, -max(-low, high), max(-low, high)), extend
    return Normalize(low, high), extend


def plot_mesh(results, number, options, title, path):
    groups = faces_of(results, number, options.field, options.scale)
    if not groups:
        raise Trouble('there are no surfaces to draw', 3)
    value_of = None if options.field == 'none' else results.source(options.field)[1]
    flat = results.ndm == 2
    look = np.eye(3) if flat else camera(options.view)
    total = sum(len(group.w) for group in groups)
    fine = int(80 / np.sqrt(total))         # few large elements need more polygons
    polygons, values, shades, depths = [], [], [], []
    curves, middles, bodies, curve_depths = [], [], [], []
    for group in groups:
        most = max(1, int(np.sqrt(MOST_POLYGONS / total)))
        na, nb = (max(1, min(most, max(3 * d, fine))) for d in (group.p, group.q))
        a, b = np.linspace(0, 1, na + 1), np.linspace(0, 1, nb + 1)
        places = group.evaluate(group.place, a, b) @ look.T
        quads = np.stack([places[:, :-1, :-1], places[:, :-1, 1:], places[:, 1:, 1:], places[:, 1:, :-1]], axis=-2)
        quads = quads.reshape(-1, 4, 3)
        visible = np.ones(len(quads), dtype=bool)
        if not flat:
            normal = np.cross(quads[:, 2] - quads[:, 0], quads[:, 3] - quads[:, 1])
            normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
            if group.closed:
                visible = normal[:, 2] > 0
            shades.append(0.62 + 0.38 * np.abs(normal @ np.array([-0.35, 0.45, 0.82]))[visible])
        polygons.append(quads[visible][..., :2])
        depths.append(quads[visible][..., 2].mean(axis=1))
        if value_of:
            middle_a, middle_b = (a[1:] + a[:-1]) / 2, (b[1:] + b[:-1]) / 2
            values.append(value_of(group.evaluate(group.field, middle_a, middle_b)).reshape(-1)[visible])
        lines, middle = edges_of(group, 2 if group.p == group.q == 1 and flat else
                                  max(4 * max(group.p, group.q), fine) + 1)
        body = np.repeat(group.body, 4)
        lines = lines @ look.T
        if not flat and group.closed:       # an edge of a face that is turned away is not seen
            corner = group.evaluate(group.place, np.array([0.45, 0.55]), np.array([0.45, 0.55])) @ look.T
            normal = np.cross(corner[:, 0, 1] - corner[:, 0, 0], corner[:, 1, 0] - corner[:, 0, 0])
            seen = np.repeat(normal[:, 2] > 0, 4)
            lines, middle, body = lines[seen], middle[seen], body[seen]
        curves += list(lines)
        middles.append(middle)
        bodies.append(body)

    polygons, depths = np.concatenate(polygons), np.concatenate(depths)
    names = keys(np.concatenate(middles), np.concatenate(bodies), extent(groups))
    count = {}
    for name in names:
        count[name] = count.get(name, 0) + 1

    points = polygons.reshape(-1, 2)
    low, high = points.min(axis=0), points.max(axis=0)
    wide, tall = np.maximum(high - low, 1e-3 * max(high - low))
    width = float(np.clip(9 * np.sqrt(wide / tall), 5.5, 14))
    figure, ax = plt.subplots(figsize=(width, float(np.clip(width * tall / wide, 3.0, 11))))
    if value_of:
        values = np.concatenate(values)
        norm, extend = colour_range(values, options.limits)
        cmap = plt.get_cmap('RdBu_r' if isinstance(norm, TwoSlopeNorm) else 'viridis').copy()
        cmap.set_bad('0.8')
        colours = cmap(norm(np.ma.masked_invalid(values)))
    else:
        colours = np.tile(matplotlib.colors.to_rgba('#b8cbdc'), (len(polygons), 1))
    if flat:
        ax.add_collection(PolyCollection(polygons, facecolors=colours, edgecolors=colours, linewidths=0.3,
                                         antialiased=False, rasterized=True))
    else:
        colours[:, :3] *= np.concatenate(shades)[:, None]
        diagonal = float(np.linalg.norm(high - low))
        items = [(depth, polygon, colour, colour, 0.3) for depth, polygon, colour in zip(depths, polygons, colours)]
        if options.edges:
            for line, name in zip(curves, names):
                thick = 0.9 if count[name] == 1 else 0.5
                for start, end in zip(line[:-1], line[1:]):
                    items.append(((start[2] + end[2]) / 2 + 0.012 * diagonal, np.array([start[:2], end[:2]]),
                                  (0, 0, 0, 0), (0, 0, 0, 0.75), thick))
        items.sort(key=lambda item: item[0])
        _, shapes, faces, rims, thick = zip(*items)
        ax.add_collection(PolyCollection(shapes, facecolors=faces, edgecolors=rims, linewidths=thick, closed=False,
                                         rasterized=True))
    if flat:
        single = [(line[:, :2], name[0]) for line, name in zip(curves, names) if count[name] == 1]
        hanging = on_another([line for line, _ in single], [body for _, body in single])
        shared = {name: line[:, :2] for line, name in zip(curves, names) if count[name] > 1}
        shared.update({('hanging', i): single[i][0] for i in np.flatnonzero(hanging)})
        single = [line for (line, _), inside in zip(single, hanging) if not inside]
        if options.edges:
            thin = float(np.clip(30 / np.sqrt(total), 0.12, 0.5))
            ax.add_collection(LineCollection(list(shared.values()), colors=[(0, 0, 0, 0.55)], linewidths=thin))
        ax.add_collection(LineCollection(single, colors=['k'], linewidths=0.9, capstyle='round'))
    margin = 0.03 * max(wide, tall)
    ax.set_xlim(low[0] - margin, high[0] + margin)
    ax.set_ylim(low[1] - margin, high[1] + margin)
    ax.set_aspect('equal')
    ax.grid(False)
    if flat:
        ax.set_xlabel('x')
        ax.set_ylabel('y')
    else:
        ax.axis('off')
        draw_axes(ax, look)
    if value_of:
        image = matplotlib.cm.ScalarMappable(norm=norm, cmap=cmap)
        if wide > 2 * tall:
            bar = figure.colorbar(image, ax=ax, extend=extend, orientation='horizontal', fraction=0.05, pad=0.24,
                                  aspect=45, shrink=0.7)
        else:
            bar = figure.colorbar(image, ax=ax, extend=extend, fraction=0.035, pad=0.03, aspect=25,
                                  shrink=float(np.clip(1.2 * tall / wide, 0.5, 0.9)))
        bar.set_label(options.field.replace('_', ' '))
        bar.outline.set_visible(False)
    scaled = '' if options.scale == 1 else f', displacement x {options.scale:g}'
    ax.set_title(f'{title}\nstep {results.steps[number]}, time {results.times[number]:.6g}{scaled}', fontsize=11)
    figure.savefig(path, dpi=options.dpi)
    plt.close(figure)


def draw_axes(ax, look):
    """A small tripod in the corner."""
    for k, name in enumerate('xyz'):
        tip = 0.055 * look[:2, k]
        start = np.array([0.07, 0.07])
        ax.annotate('', start + tip, start, xycoords='axes fraction', arrowprops={'arrowstyle': '->', 'lw': 1.0})
        ax.annotate(name, start + 1.35 * tip, xycoords='axes fraction', ha='center', va='center', fontsize=9)


# ---------------------------------------------------------------- command

def read_options():
    parser = argparse.ArgumentParser(prog='driver/plot', description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('folder', metavar='DIR', help='result folder; the pictures go into it')
    parser.add_argument('--field', help='what colours the mesh: u, ux, uy, uz, stress_xx, ..., stress_mises, any other '
                        'field of the results, none (default: stress_mises if there is a stress, else u)')
    parser.add_argument('--step', type=int, action='append', help='picture of the output at this step (may be '
                        'repeated; default: the last output)')
    parser.add_argument('--every', type=int, metavar='N', help='picture of every N-th output')
    parser.add_argument('--scale', type=float, default=1.0, help='factor on displacements (default 1)')
    parser.add_argument('--limits', type=float, nargs=2, metavar=('LOW', 'HIGH'), help='range of the colours')
    parser.add_argument('--view', type=float, nargs=2, default=(-60, 25), metavar=('AZIMUTH', 'ELEVATION'),
                        help='where a solid is seen from, in degrees (default -60 25)')
    parser.add_argument('--no-edges', dest='edges', action='store_false', help='no edges of elements')
    parser.add_argument('--no-history', dest='history', action='store_false', help='no curves')
    parser.add_argument('--no-mesh', dest='mesh', action='store_false', help='no mesh')
    parser.add_argument('--dpi', type=int, default=160, help='resolution of mesh pictures (default 160)')
    return parser.parse_args()


def claim(folder, path):
    """Put the picture on the list of files that a later run may replace."""
    marker = folder / '.bezel'
    if marker.exists() and path.name not in marker.read_text().splitlines():
        with open(marker, 'a') as file:
            file.write(path.name + '\n')


def chosen_outputs(results, options):
    if not len(results.steps):
        raise Trouble('there are no outputs yet', 3)
    chosen = []
    for step in options.step or []:
        found = np.flatnonzero(results.steps == step)
        if not len(found):
            known = ', '.join(str(s) for s in results.steps[:40])
            raise Trouble(f'there is no output at step {step}. Outputs are at: {known}'
                          + (', ...' if len(results.steps) > 40 else '') + '.', 2)
        chosen.append(int(found[0]))
    if options.every is not None:
        if options.every < 1:
            raise Trouble('--every needs a number from 1', 2)
        chosen += range(0, len(results.steps), options.every)
    return sorted(set(chosen)) or [len(results.steps) - 1]


def run(options):
    folder = Path(options.folder)
    if not folder.is_dir():
        raise Trouble(f'there is no folder {folder}', 2)
    history, stored = folder / 'history.csv', folder / 'results.vtkhdf'
    if not history.exists() and not stored.exists():
        raise Trouble(f'{folder} holds no results of bezel', 2)
    results = Results(stored) if stored.exists() else None
    title = (results.title() if results else '') or folder.name.removesuffix('.out')
    written = []

    def done(path):
        claim(folder, path)
        print(path)
        written.append(path)

    if options.history and history.exists():
        data = read_history(history)
        if len(data['time']):
            path = folder / 'history.png'
            plot_history(data, title, path)
            done(path)
    if options.mesh and results:
        if options.field is None:
            options.field = 'stress_mises' if 'stress_mises' in results.known_fields() else 'u'
        if options.field != 'none':
            results.source(options.field)
        for number in chosen_outputs(results, options):
            path = folder / f'{options.field}_{results.steps[number]:06d}.png'
            plot_mesh(results, number, options, title, path)
            done(path)
    elif options.mesh and (options.field or options.step or options.every):
        raise Trouble(f'{folder} has no results.vtkhdf: the deck asked for no fields', 2)
    if not written:
        raise Trouble('there is nothing to draw yet', 3)


def main():
    options = read_options()
    try:
        run(options)
    except Trouble as trouble:
        print(f'plot: {trouble}', file=sys.stderr)
        return trouble.status
    except OSError as error:
        print(f'plot: {error}', file=sys.stderr)
        return 3
    return 0


if __name__ == '__main__':
    status = main()
    sys.exit(status)
