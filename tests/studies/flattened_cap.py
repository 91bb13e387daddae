"""A hemispherical shell of revolution pressed on a rigid plane: what two equal ones that face each other do by symmetry.

An axisymmetric Kirchhoff-Love shell, independent of the program: the meridian r(s), z(s) in cubic B-splines, Green-Lagrange
membrane strains and changes of the covariant curvatures, St. Venant-Kirchhoff, penalty at the plane z = 0, Newton's method.
"""
import numpy


class Jet:
    """A value with its first and second derivatives by n variables, at many places."""

    def __init__(self, value, slope, bend):
        self.value, self.slope, self.bend = value, slope, bend

    @classmethod
    def variables(cls, values):
        n, m = values.shape
        return [cls(values[i], numpy.eye(n)[i][:, None] * numpy.ones(m), numpy.zeros((n, n, m))) for i in range(n)]

    def of(self, f, df, ddf):
        return Jet(f, df * self.slope, df * self.bend + ddf * self.slope[:, None] * self.slope[None])

    def __add__(self, other):
        if not isinstance(other, Jet):
            return Jet(self.value + other, self.slope, self.bend)
        return Jet(self.value + other.value, self.slope + other.slope, self.bend + other.bend)

    def __mul__(self, other):
        if not isinstance(other, Jet):
            return Jet(self.value * other, self.slope * other, self.bend * other)
        cross = self.slope[:, None] * other.slope[None]
        return Jet(self.value * other.value, self.value * other.slope + other.value * self.slope,
                   self.value * other.bend + other.value * self.bend + cross + cross.transpose(1, 0, 2))

    def __sub__(self, other):
        return self + other * -1

    def inverse_root(self):
        f = self.value**-0.5
        return self.of(f, -0.5 * f**3, 0.75 * f**5)

    __radd__, __rmul__ = __add__, __mul__


def splines(knots, x):
    """Values and two derivatives of the cubic B-splines of an open knot vector: (3, points, functions)."""
    n = len(knots) - 4
    table = {0: numpy.array([(knots[i] <= x) & (x < knots[i + 1]) for i in range(len(knots) - 1)], float)}

    def quotient(a, b):
        return a / b if b > 0 else 0 * a

    for p in (1, 2, 3):
        old = table[p - 1]
        table[p] = numpy.array([quotient((x - knots[i]) * old[i], knots[i + p] - knots[i])
                                + quotient((knots[i + p + 1] - x) * old[i + 1], knots[i + p + 1] - knots[i + 1])
                                for i in range(len(knots) - 1 - p)])

    def lower(p, i, order):
        if order == 0:
            return table[p][i]
        return (quotient(p * lower(p - 1, i, order - 1), knots[i + p] - knots[i])
                - quotient(p * lower(p - 1, i + 1, order - 1), knots[i + p + 1] - knots[i + 1]))

    return numpy.array([[lower(3, i, order) for i in range(n)] for order in range(3)]).transpose(0, 2, 1)


def press(depths, E=1e3, nu=0.3, R=1.0, t=0.1, penalty=2e4, elements=200, pinned=True):
    """For each depth by which the rim moves towards the plane: depth, force, height of the apex, largest penetration."""
    breaks = R * numpy.pi / 2 * numpy.linspace(0, 1, elements + 1)**1.5
    knots = numpy.concatenate([[0] * 3, breaks, [breaks[-1]] * 3])
    g, w = numpy.polynomial.legendre.leggauss(4)
    half = numpy.diff(breaks)[:, None] / 2
    s = ((breaks[:-1] + breaks[1:])[:, None] / 2 + half * g).ravel()
    N, N1, N2 = splines(knots, s)
    n = N.shape[1]
    r0 = R * numpy.sin(s / R)
    measure = 2 * numpy.pi * r0 * (half * w).ravel()
    membrane, bending = E * t / (1 - nu**2), E * t**3 / 12 / (1 - nu**2)
    # control values of the sphere: interpolation at as many points
    greville = numpy.array([knots[i + 1:i + 4].mean() for i in range(n)])
    at = splines(knots, numpy.minimum(greville, breaks[-1] * (1 - 1e-14)))[0]
    q = numpy.concatenate([numpy.linalg.solve(at, R * numpy.sin(greville / R)), numpy.linalg.solve(at, R - R * numpy.cos(greville / R))])
    q[n] = q[n + 1]
    # r = 0 and z' = 0 at the pole, r given at the rim, z prescribed there
    free = numpy.ones(2 * n, bool)
    free[[0, n, n - 1, 2 * n - 1]] = False
    if not pinned:
        free[n - 1] = True
    tie = numpy.eye(2 * n)
    tie[n, n + 1] = 1
    tie = tie[:, free]
    blocks = numpy.array([N, N1, N2, N1, N2, N])
    columns = [slice(0, n)] * 3 + [slice(n, 2 * n)] * 3
    rows = []
    for depth in depths:
        moved = numpy.zeros(2 * n)
        moved[2 * n - 1] = R - depth - q[2 * n - 1]
        for _ in range(60):
            r, r1, r2, z1, z2 = Jet.variables(numpy.array([blocks[k] @ q[columns[k]] for k in range(5)]))
            stretch = r1 * r1 + z1 * z1
            E1 = (stretch + -1.0) * 0.5
            E2 = (r * r * (1 / r0**2) + -1.0) * 0.5
            over = stretch.inverse_root()
            K1 = (z2 * r1 - r2 * z1) * over + -1 / R
            K2 = r * z1 * over * (1 / r0**2) + -1 / R
            energy = ((E1 * E1 + E2 * E2 + E1 * E2 * (2 * nu)) * (membrane / 2)
                      + (K1 * K1 + K2 * K2 + K1 * K2 * (2 * nu)) * (bending / 2))
            gap = numpy.minimum(N @ q[n:], 0)
            force, stiff = numpy.zeros(2 * n), numpy.zeros((2 * n, 2 * n))
            for a in range(5):
                force[columns[a]] += blocks[a].T @ (energy.slope[a] * measure)
                for b in range(5):
                    stiff[columns[a], columns[b]] += blocks[a].T @ ((energy.bend[a, b] * measure)[:, None] * blocks[b])
            force[n:] += N.T @ (penalty * gap * measure)
            stiff[n:, n:] += N.T @ ((penalty * (gap < 0) * measure)[:, None] * N)
            rest, tangent = tie.T @ force, tie.T @ stiff @ tie
            if abs(rest).max() < 1e-7 * abs(force).max() + 1e-11 * E * t * R and not moved.any():
                break
            q += tie @ numpy.linalg.solve(tangent, -rest - tie.T @ (stiff @ moved)) + moved
            moved[:] = 0
        else:
            raise SystemExit(f"flattened_cap: no convergence at the depth {depth}")
        rows.append((depth, -force[2 * n - 1], q[n], -gap.min()))
    return numpy.array(rows)


if __name__ == "__main__":
    for row in press(numpy.linspace(0, 0.1, 16)[1:]):
        print(*(f"{value:.6g}" for value in row))
