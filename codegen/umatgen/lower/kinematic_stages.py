"""Stages of kinematics: from F0, F1 to invariants and spatial generators, in the material frame (fibre along axis 1)."""

from __future__ import annotations

import sympy as sp

from umatgen.lower.assign import Assignment, element, from_definitions
from umatgen.lower.stage import Stage, Variable, make_stage
from umatgen.model.generators import MEAN_RATE, VOIGT
from umatgen.model.kinematics import strain_rate_from_rates, transverse_definitions
from umatgen.model.rates import GROWTH, RATIO, growth_of_rate, rate_formula, ratio_of_rates
from umatgen.notation import sym

COINCIDENT = "1e-14"  # of a22 + a33: transverse stretches closer than that have no direction of their own
Vector = tuple[sp.Expr, sp.Expr, sp.Expr]


def column(array: str, j: int) -> Vector:
    """Column j (1-based) of a 3x3 array: the image of material basis vector j."""
    first, second, third = (element(f"{array}({i},{j})") for i in (1, 2, 3))
    return first, second, third


def dot(u: Vector, v: Vector) -> sp.Expr:
    """Scalar product."""
    return sp.Add(*(a * b for a, b in zip(u, v, strict=True)))


def cross(u: Vector, v: Vector) -> Vector:
    """Vector product."""
    return (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])


def _transverse_area(array: str, fibre: int) -> tuple[list[Assignment], Vector]:
    names = tuple(f"area_{i}" for i in (1, 2, 3))
    _, m2, m3 = axes(fibre)
    values = cross(column(array, m2), column(array, m3))
    body = [Assignment(name, value) for name, value in zip(names, values, strict=True)]
    return body, (element(names[0]), element(names[1]), element(names[2]))


def axes(fibre: int) -> tuple[int, int, int]:
    """Numbers of the fibre axis and of the two transverse ones, right-handed; 0 (rotated beforehand) counts as 1."""
    first = max(fibre, 1)
    return first, first % 3 + 1, (first + 1) % 3 + 1


def start_stage(fibre: int = 1) -> Stage:
    """Smallest transverse stretch at the start of the increment: which stage of flow the increment belongs to."""
    n, m2, m3 = axes(fibre)
    body, area = _transverse_area("f0", fibre)
    p2, p3 = column("f0", m2), column("f0", m3)
    a22, a33, a23 = (element(f"a{n}_start") for n in ("22", "33", "23"))
    body += [
        Assignment("det_f_start", dot(column("f0", n), area)),
        Assignment("a22_start", dot(p2, p2)),
        Assignment("a33_start", dot(p3, p3)),
        Assignment("a23_start", dot(p2, p3)),
        Assignment("area2_start", dot(area, area)),
        Assignment("x_start", 2 * element("area2_start") / (a22 + a33 + sp.sqrt((a22 - a33) ** 2 + 4 * a23**2))),
    ]
    return make_stage(
        "start", "Volume ratio and smallest transverse eigenvalue at the start of the increment", "sec. 4.4",
        "f0", "det_f_start x_start", body, sharing="none",
    )  # fmt: skip


def kinematics_stage(fibre: int = 1, integrator: str = "bdf1", directions: bool = True) -> Stage:
    """Invariants, rate of C and the spatial generators.

    `directions`: whether the direction of the compaction matters (in the tangent); then A22 - A33 must not cancel. The
    stretches do not mind: they take the difference relative to the sum.

    C1 - C0 is formed as F1^T (F1-F0) + (F1-F0)^T F0: no small difference of large numbers. J comes from
    the triple product, det A from the squared area vector, so neither cancels.
    """
    z, p2, p3 = (column("f1", j) for j in axes(fibre))
    a22, a33 = sym("a22", "a33")
    c11, c12, c13 = (element(n) for n in ("c11", "c12", "c13"))
    body, area = _transverse_area("f1", fibre)
    body += [Assignment("det_f", dot(z, area)), Assignment("area2", dot(area, area))]
    body += [
        Assignment("c11", dot(z, z)), Assignment("c12", dot(z, p2)), Assignment("c13", dot(z, p3)),
        Assignment("a22", dot(p2, p2)), Assignment("a33", dot(p3, p3)), Assignment("a23", dot(p2, p3)),
    ]  # fmt: skip
    difference = tuple(a - b for a, b in zip(p2, p3, strict=True))
    total = tuple(a + b for a, b in zip(p2, p3, strict=True))
    products = sp.Add(*(a * b for a, b in zip(difference, total, strict=True)))
    body.append(Assignment("spread", products if directions else a22 - a33))
    body.append(Assignment("a_diff", element("spread") / 2))
    body += [
        Assignment("i1", c11 + a22 + a33),
        Assignment("i4", c11),
        Assignment("i5", c11**2 + c12**2 + c13**2),
    ]
    body += _rate(integrator) + _generators(z, p2, p3, fibre)
    outputs = "det_f area2 a22 a33 a23 a_diff i1 i4 i5 c12 c13 cdot j2 b_left fibre fibre_c m22 m33 m23 y_rate"
    inputs = "f0 f1 dt"
    if integrator != "bdf1":
        inputs += " history rate_last"
        outputs += " rate_mean"
    if integrator == "bdf2log":
        inputs += " j2_floor"
        outputs += " growth turn_dyad turn_slope y_mean"
        body += _spatial_rate(z, p2, p3, fibre, "rate_mean", MEAN_RATE.key) + _turn()
    arrays = (Variable("f_step", (3, 3)),)
    return make_stage(
        "kinematics", f"Invariants, rate of C and spatial generators (fibre along axis {max(fibre, 1)})", "9, sec. 4.2-4.3",
        inputs, outputs, body, arrays, sharing="none",
    )  # fmt: skip


def _rate(integrator: str) -> list[Assignment]:
    """Cdot in tensor components, and J2 = (1/2) Cdot:Cdot."""
    (dt,) = sym("dt")
    body = [Assignment("per_time", 1 / dt)]
    mean = "cdot" if integrator == "bdf1" else "rate_mean"
    for j in (1, 2, 3):
        body += [Assignment(f"f_step({i},{j})", element(f"f1({i},{j})") - element(f"f0({i},{j})")) for i in (1, 2, 3)]
    for index, (i, j) in enumerate(VOIGT):
        end, start = column("f1", i + 1), column("f0", j + 1)
        if i == j:
            value = dot(tuple(a + b for a, b in zip(end, start, strict=True)), column("f_step", j + 1))
        else:
            value = dot(end, column("f_step", j + 1)) + dot(column("f_step", i + 1), start)
        body.append(Assignment(f"{mean}({index + 1})", element("per_time") * value))
    body += _two_step_rate(integrator) if integrator != "bdf1" else []
    normal = Assignment("cdot_normal2", sp.Add(*(element(f"cdot({i})") ** 2 for i in (1, 2, 3))))
    shear = sp.Add(*(element(f"cdot({i})") ** 2 for i in (4, 5, 6)))
    return [*body, normal, Assignment("j2", element("cdot_normal2") / 2 + shear)]


def _half_contraction(first: str, second: str) -> sp.Expr:
    """(1/2) A:B of two symmetric tensors in Voigt order."""
    terms = [element(f"{first}({i})") * element(f"{second}({i})") for i in range(1, 7)]
    return sp.Add(*terms[:3]) / 2 + sp.Add(*terms[3:])


def _two_step_rate(integrator: str) -> list[Assignment]:
    """Cdot from the mean rates of this increment and of the one before."""
    formula, body = rate_formula(integrator), []
    if integrator == "bdf2log":
        body = [
            Assignment("j2_mean", _half_contraction("rate_mean", "rate_mean")),
            Assignment("j2_before", _half_contraction("rate_last", "rate_last")),
            Assignment(RATIO.name, ratio_of_rates()),
            Assignment(GROWTH.name, growth_of_rate()),
        ]
    body += [Assignment("gain", formula.gain), Assignment("back", formula.back)]
    for i in range(1, 7):
        value = element("gain") * element(f"rate_mean({i})") - element("back") * element(f"rate_last({i})")
        body.append(Assignment(f"cdot({i})", value))
    return body


def _turn() -> list[Assignment]:
    """Coefficients of (Cdot - growth r) (r : dr): in Cdot itself, and in J2."""
    dt, j2 = sym("dt", "j2")
    turn = element("turn_dyad")
    return [
        Assignment("turn_dyad", rate_formula("bdf2log").turn / dt),
        Assignment("turn_slope", turn * (2 * j2 - GROWTH * 2 * _half_contraction("cdot", "rate_mean"))),
    ]


def _generators(z: Vector, p2: Vector, p3: Vector, fibre: int) -> list[Assignment]:
    c11, c12, c13 = (element(n) for n in ("c11", "c12", "c13"))
    bz_names = ("bz_1", "bz_2", "bz_3")
    body = [Assignment(name, z[i] * c11 + p2[i] * c12 + p3[i] * c13) for i, name in enumerate(bz_names)]
    bz = [element(name) for name in bz_names]
    for index, (i, j) in enumerate(VOIGT):
        n = index + 1
        m23 = 2 * p2[i] * p3[i] if i == j else p2[i] * p3[j] + p3[i] * p2[j]
        fibre_c = 2 * z[i] * bz[i] if i == j else z[i] * bz[j] + bz[i] * z[j]
        body += [
            Assignment(f"fibre({n})", z[i] * z[j]),
            Assignment(f"m22({n})", p2[i] * p2[j]),
            Assignment(f"m33({n})", p3[i] * p3[j]),
            Assignment(f"m23({n})", m23),
            Assignment(f"b_left({n})", element(f"fibre({n})") + element(f"m22({n})") + element(f"m33({n})")),
            Assignment(f"fibre_c({n})", fibre_c),
        ]
    return body + _spatial_rate(z, p2, p3, fibre)


def _spatial_rate(
    z: Vector, p2: Vector, p3: Vector, fibre: int, rate: str = "cdot", target: str = "y_rate"
) -> list[Assignment]:
    """Y = F Cdot F^T through h = F Cdot (or of another rate)."""
    h = "h" if rate == "cdot" else "h_mean"
    rates = sp.zeros(3, 3)
    for index, (i, j) in enumerate(VOIGT):
        rates[i, j] = rates[j, i] = element(f"{rate}({index + 1})")
    body, columns = [], dict(zip((n - 1 for n in axes(fibre)), (z, p2, p3), strict=True))
    for i in range(3):
        for j in range(3):
            body.append(Assignment(f"{h}_{i + 1}{j + 1}", sp.Add(*(columns[m][i] * rates[m, j] for m in range(3)))))
    for index, (i, j) in enumerate(VOIGT):
        value = sp.Add(*(element(f"{h}_{i + 1}{m + 1}") * columns[m][j] for m in range(3)))
        body.append(Assignment(f"{target}({index + 1})", value))
    return body


def transverse_stage(fibre: int = 1) -> Stage:
    """Mohr's circle of A: compaction stretch, width and direction, without cancellation."""
    radius, a_diff, a22, a33, a23, area2, x_min = sym("radius", "a_diff", "a22", "a33", "a23", "area2", "x_min")
    skipped = {"a_diff", "area2"}
    body = [a for a in from_definitions(transverse_definitions()) if a.target not in skipped]
    safe = sp.Max(radius, sp.Mul(sp.Float(COINCIDENT), a22 + a33, evaluate=False), evaluate=False)
    position = next(i for i, a in enumerate(body) if a.target == "radius") + 1
    body[position:position] = [Assignment("inverse_radius", 1 / safe)]
    body[position + 1 : position + 1] = [
        Assignment("cos2", a_diff * element("inverse_radius")),
        Assignment("sin2", a23 * element("inverse_radius")),
    ]
    body.append(Assignment("width", sp.sqrt(area2 / x_min)))
    cdot = {sp.Symbol(f"cdot_{n}", real=True): element(f"cdot({i})") for n, i in _transverse_places(fibre)}
    body.append(Assignment("eps_rate", strain_rate_from_rates().subs(cdot)))
    return make_stage(
        "transverse", "Smallest transverse eigenvalue x, its direction, and the stretches", "13 (I1^s), sec. 4.3",
        "a22 a33 a23 a_diff area2 cdot", "x_min stretch a_norm2 cos2 sin2 width eps_rate", body,
    )  # fmt: skip


def _transverse_places(fibre: int) -> list[tuple[str, int]]:
    """Voigt numbers (1-based) of the components 22, 33, 23 of the transverse basis."""
    _, m2, m3 = axes(fibre)
    places = {"22": (m2, m2), "33": (m3, m3), "23": (min(m2, m3), max(m2, m3))}
    return [(name, VOIGT.index((i - 1, j - 1)) + 1) for name, (i, j) in places.items()]


def frame_stage() -> Stage:
    """Rotate the material basis so that a free fibre direction n becomes axis 1: G = F Q with Q = (n, p2, p3).

    The transverse basis is that of Duff et al. (2017): without a branch and without cancellation. Spatial quantities do not
    change when the material basis is rotated, so nothing is rotated back.
    """
    directions = [element(f"dir_{i}") for i in (1, 2, 3)]
    n1, n2, n3 = (element(f"n_{i}") for i in (1, 2, 3))
    sign, inverse, mixed = element("sign_3"), element("inverse"), element("mixed")
    units = [element(f"unit_{i}") for i in (1, 2, 3)]
    body = [Assignment("longest", sp.Max(*(sp.Abs(d) for d in directions)))]
    body += [Assignment(u.name, d / element("longest")) for u, d in zip(units, directions, strict=True)]
    body += [Assignment("per_length", 1 / sp.sqrt(sp.Add(*(u**2 for u in units))))]
    body += [Assignment(f"n_{i}", u * element("per_length")) for i, u in enumerate(units, 1)]
    body += [
        Assignment("sign_3", element("sign(1.0d0,n_3)")),
        Assignment("inverse", -1 / (sign + n3)),
        Assignment("mixed", n1 * n2 * inverse),
    ]
    basis = (
        (n1, n2, n3),
        (1 + sign * n1**2 * inverse, sign * mixed, -sign * n1),
        (mixed, sign + n2**2 * inverse, -n2),
    )
    for target, array in (("g0", "f0"), ("g1", "f1")):
        for j, vector in enumerate(basis, 1):
            for i in (1, 2, 3):
                row = sp.Add(*(element(f"{array}({i},{m})") * vector[m - 1] for m in (1, 2, 3)))
                body.append(Assignment(f"{target}({i},{j})", row))
    return make_stage(
        "frame", "Material frame with the fibre along axis 1", "sec. 4.1", "dir_1 dir_2 dir_3 f0 f1", "g0 g1", body
    )
