"""Stages of kinematics: from F0, F1 to invariants, rate of C and spatial generators, in the material frame."""

from __future__ import annotations

import sympy as sp

from umatgen.lower.assign import Assignment, element, from_definitions
from umatgen.lower.stage import Stage, Variable, make_stage
from umatgen.model.generators import VOIGT
from umatgen.model.kinematics import mohr_definitions, normal_definitions, strain_rate
from umatgen.notation import sym
from umatgen.scene import Scene

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


def place(i: int, j: int) -> int:
    """Voigt number (1-based) of a component by its material axes (1-based)."""
    return VOIGT.index((min(i, j) - 1, max(i, j) - 1)) + 1


def area(array: str, scene: Scene, over: str) -> tuple[list[Assignment], Vector]:
    """Image of the unit area across the normal (`over` = "normal") or the fibre ("fibre"), so that J = area . column."""
    fibre, across, normal = scene.axes
    first, second = (fibre, across) if over == "normal" else (across, normal)
    if (across - fibre) % 3 != 1:  # the axes are an odd permutation of 1, 2, 3
        first, second = second, first
    names = ("area_1", "area_2", "area_3")
    values = cross(column(array, first), column(array, second))
    body = [Assignment(name, value) for name, value in zip(names, values, strict=True)]
    return body, (element(names[0]), element(names[1]), element(names[2]))


def start_stage(scene: Scene) -> Stage:
    """Volume ratio and squared compaction stretch at the start of the increment."""
    fibre, across, normal = scene.axes
    if scene.compaction != "smallest":
        body, vector = area("f0", scene, "normal")
        body.append(Assignment("det_f_start", dot(column("f0", normal), vector)))
        body.append(Assignment("x_start", element("det_f_start") ** 2 / dot(vector, vector)))
        title = "Volume ratio and squared stretch along the ply normal at the start of the increment"
        return make_stage("start", title, "9, 4.4", "f0", "det_f_start x_start", body, sharing="none",
                          formula=("x = 1/(N . C**-1 N) = J**2/|F n x F t|**2",))  # fmt: skip
    body, vector = area("f0", scene, "fibre")
    p2, p3 = column("f0", across), column("f0", normal)
    a22, a33, a23, area2 = (element(f"{n}_start") for n in ("a22", "a33", "a23", "area2"))
    body += [
        Assignment("det_f_start", dot(column("f0", fibre), vector)),
        Assignment("a22_start", dot(p2, p2)),
        Assignment("a33_start", dot(p3, p3)),
        Assignment("a23_start", dot(p2, p3)),
        Assignment("area2_start", dot(vector, vector)),
        Assignment("x_start", 2 * area2 / (a22 + a33 + sp.sqrt((a22 - a33) ** 2 + 4 * a23**2))),
    ]
    title = "Volume ratio and smallest transverse eigenvalue at the start of the increment"
    return make_stage("start", title, "9, 4.4", "f0", "det_f_start x_start", body, sharing="none")


def compaction_stage(scene: Scene) -> Stage:
    """Invariants of C at the end of the increment, and the compaction stretch with its direction."""
    fibre, _, normal = scene.axes
    z, p2, p3 = (column("f1", j) for j in scene.axes)
    smallest = scene.compaction == "smallest"
    body, vector = area("f1", scene, "fibre" if smallest else "normal")
    body += [
        Assignment("det_f", dot(z if smallest else p3, vector)),
        Assignment("i4", dot(z, z)), Assignment("c12", dot(z, p2)), Assignment("c13", dot(z, p3)),
        Assignment("a22", dot(p2, p2)), Assignment("a33", dot(p3, p3)), Assignment("a23", dot(p2, p3)),
        Assignment("i1", sp.Add(*sym("i4", "a22", "a33"))),
        Assignment("i5", sym("i4")[0] ** 2 + element("c12") ** 2 + element("c13") ** 2),
    ]  # fmt: skip
    body += _mohr(p2, p3, vector, scene) if smallest else _along_normal(vector)
    direction = "cos2 sin2" if smallest else "tilt_1 tilt_2 normal"
    if scene.holds_width:
        body += [Assignment("area", sp.sqrt(sym("area2")[0])), *_plane()]
        direction += " area plane"
    return make_stage(
        "compaction", f"Invariants of C and the compaction stretch (fibre along axis {fibre}, ply normal along axis {normal})",
        "9, 4.3, 13", "f1", f"det_f i1 i4 i5 c12 c13 a22 a33 a23 a_norm2 x_end stretch width {direction}", body, sharing="none",
        formula=_SMALLEST if smallest else _NORMAL,
    )  # fmt: skip


_NORMAL = (
    "x = 1/(N . C**-1 N) = J**2/|F n x F t|**2, stretch = sqrt(x) = exp(eps), A = J/sqrt(x) the in-plane area ratio; C**-1 N "
    "= (tilt_1, tilt_2, 1)/x in the axes n, t, N.",
    "The paper prints I1**s, the smaller root of x**2 - (I1 - 1) x + I3 = 0: the same where the fibre neither stretches nor shears.",
)
_SMALLEST = (
    "x is the smallest eigenvalue of the transverse block A of C: the paper's I1**s where the fibre neither stretches nor shears.",
)


def _along_normal(vector: Vector) -> list[Assignment]:
    """Stretch along the ply normal, its spatial direction, and C^-1 N in the material axes."""
    area2, a22, a23 = sym("area2", "a22", "a23")
    c11, c12, c13 = sym("i4", "c12", "c13")
    body = [Assignment("area2", dot(vector, vector)), *from_definitions(normal_definitions())]
    body += [
        Assignment("width", sp.sqrt(area2 / c11)),
        Assignment("tilt_1", (c12 * a23 - c13 * a22) / area2),
        Assignment("tilt_2", (c12 * c13 - c11 * a23) / area2),
    ]
    body += [Assignment(f"part_{i + 1}", vector[i] / area2) for i in range(3)]
    for index, (i, j) in enumerate(VOIGT, 1):
        body.append(Assignment(f"normal({index})", element(f"part_{i + 1}") * vector[j]))
    return body


def _plane() -> list[Assignment]:
    """The projector on the ply plane."""
    return [Assignment(f"plane({n})", (sp.S.One if i == j else sp.S.Zero) - element(f"normal({n})"))
            for n, (i, j) in enumerate(VOIGT, 1)]  # fmt: skip


def _mohr(p2: Vector, p3: Vector, vector: Vector, scene: Scene) -> list[Assignment]:
    """Mohr's circle of A, without cancellation: A22 - A33 from sums and differences of the columns of F."""
    radius, a_diff, a22, a33, a23, area2, x_end = sym("radius", "a_diff", "a22", "a33", "a23", "area2", "x_end")
    pairs = list(zip(p2, p3, strict=True))
    spread = sp.Add(*((a - b) * (a + b) for a, b in pairs)) if scene.tangent != "none" else a22 - a33
    body = [Assignment("area2", dot(vector, vector)), Assignment("spread", spread)]
    body.append(Assignment("a_diff", element("spread") / 2))
    mohr = [a for a in from_definitions(mohr_definitions()) if a.target not in {"a_diff", "area2"}]
    safe = sp.Max(radius, sp.Mul(sp.Float(COINCIDENT), a22 + a33, evaluate=False), evaluate=False)
    after = next(i for i, a in enumerate(mohr) if a.target == "radius") + 1
    mohr[after:after] = [
        Assignment("inverse_radius", 1 / safe),
        Assignment("cos2", a_diff * element("inverse_radius")),
        Assignment("sin2", a23 * element("inverse_radius")),
    ]
    return [*body, *mohr, Assignment("width", sp.sqrt(area2 / x_end))]


def kinematics_stage(scene: Scene) -> Stage:
    """Rate of C and the spatial generators.

    C1 - C0 is formed as F1^T (F1-F0) + (F1-F0)^T F0: no small difference of large numbers. In the increment that passes the
    lock `widening` stretches F0 across the fibre to the width that the ply has at the lock (`umatgen.model.lock`).
    """
    body = _rate(scene) + _generators(scene)
    smallest = scene.compaction == "smallest"
    outputs = f"cdot j2 eps_rate b_left fibre fibre_c {'m22 m33 m23' if smallest else 'transverse'} y_rate"
    inputs = "f0 f1 per_time i4 c12 c13"
    inputs += " x_end cos2 sin2" if smallest else " a22 a33 a23 x_end tilt_1 tilt_2"
    inputs += " widening in_plane" if scene.both_regimes else ""
    return make_stage(
        "kinematics", "Rate of C and the spatial generators", "9, 4.2", inputs, outputs, body, (Variable("f_step", (3, 3)),),
        sharing="none", formula=(
            "Cdot = (C1 - C0)/dt, C1 - C0 = F1^T (F1 - F0) + (F1 - F0)^T F0; y = F Cdot F^T, z = F n, bz = F C n; rate of eps: "
            "n . D n along the normal of the deformed ply.",
        ),
    )  # fmt: skip


def _from(scene: Scene, j: int) -> Vector:
    """Column j of F0, the one across the fibre widened where the lock is passed."""
    if scene.both_regimes and j == scene.axes[1]:
        return element("from_1"), element("from_2"), element("from_3")
    return column("f0", j)


def _rate(scene: Scene) -> list[Assignment]:
    """Cdot in tensor components, J2 = (1/2) Cdot:Cdot and the rate of eps."""
    across = scene.axes[1]
    body = []
    if scene.both_regimes:
        body += [Assignment(f"from_{i}", element("widening") * element(f"f0({i},{across})")) for i in (1, 2, 3)]
    for j in (1, 2, 3):
        ends = zip((1, 2, 3), column("f1", j), _from(scene, j), strict=True)
        body += [Assignment(f"f_step({i},{j})", end - start) for i, end, start in ends]
    for index, (i, j) in enumerate(VOIGT, 1):
        end, start = column("f1", i + 1), _from(scene, j + 1)
        if i == j:
            both = tuple(a + b for a, b in zip(end, start, strict=True))
            value = dot((both[0], both[1], both[2]), column("f_step", j + 1))
        else:
            value = dot(end, column("f_step", j + 1)) + dot(column("f_step", i + 1), start)
        body.append(Assignment(f"cdot({index})", sym("per_time")[0] * value))

    def square(i: int, j: int) -> sp.Expr:
        """Square of a component, by the axes n, t, N."""
        return element(f"cdot({place(scene.axes[i - 1], scene.axes[j - 1])})") ** 2

    named = {sp.Symbol(f"cdot_{i}{j}", real=True): element(f"cdot({place(scene.axes[i - 1], scene.axes[j - 1])})")
             for i in (1, 2, 3) for j in range(i, 4)}  # fmt: skip
    counted = element("in_plane") if scene.both_regimes else sp.S.One
    stretching = sp.Add(counted * sp.Add(square(1, 1), square(2, 2)), square(3, 3))
    j2 = sp.Add(sp.Mul(sp.Rational(1, 2), stretching, evaluate=False), counted * square(1, 2), square(1, 3), square(2, 3))
    return [
        *body,
        Assignment("j2", j2),
        Assignment("eps_rate", strain_rate(scene.compaction).subs(named)),
    ]


def _generators(scene: Scene) -> list[Assignment]:
    z, p2, p3 = (column("f1", j) for j in scene.axes)
    c11, c12, c13 = sym("i4", "c12", "c13")
    bz_names = ("bz_1", "bz_2", "bz_3")
    body = [Assignment(name, z[i] * c11 + p2[i] * c12 + p3[i] * c13) for i, name in enumerate(bz_names)]
    bz = [element(name) for name in bz_names]
    for n, (i, j) in enumerate(VOIGT, 1):
        fibre_c = 2 * z[i] * bz[i] if i == j else z[i] * bz[j] + bz[i] * z[j]
        body += [
            Assignment(f"fibre({n})", z[i] * z[j]),
            Assignment(f"b_left({n})", element(f"fibre({n})") + p2[i] * p2[j] + p3[i] * p3[j]),
            Assignment(f"fibre_c({n})", fibre_c),
        ]
    return body + (_transverse_dyads(p2, p3) if scene.compaction == "smallest" else _transverse_block(p2, p3)) + _spatial_rate()


def _transverse_dyads(p2: Vector, p3: Vector) -> list[Assignment]:
    """The dyads of F t and F N."""
    body = []
    for n, (i, j) in enumerate(VOIGT, 1):
        body += [Assignment(f"m22({n})", p2[i] * p2[j]), Assignment(f"m33({n})", p3[i] * p3[j])]
        body.append(Assignment(f"m23({n})", 2 * p2[i] * p3[i] if i == j else p2[i] * p3[j] + p3[i] * p2[j]))
    return body


def _transverse_block(p2: Vector, p3: Vector) -> list[Assignment]:
    """F A F^T = (F t) q_t + (F N) q_N, q = F A t and F A N."""
    a22, a33, a23 = sym("a22", "a33", "a23")
    rows = range(3)
    body = [Assignment(f"qt_{i + 1}", a22 * p2[i] + a23 * p3[i]) for i in rows]
    body += [Assignment(f"qn_{i + 1}", a23 * p2[i] + a33 * p3[i]) for i in rows]
    for n, (i, j) in enumerate(VOIGT, 1):
        body.append(Assignment(f"transverse({n})", p2[i] * element(f"qt_{j + 1}") + p3[i] * element(f"qn_{j + 1}")))
    return body


def _spatial_rate() -> list[Assignment]:
    """Y = F Cdot F^T through h = F Cdot."""
    rates = sp.zeros(3, 3)
    for index, (i, j) in enumerate(VOIGT, 1):
        rates[i, j] = rates[j, i] = element(f"cdot({index})")
    body, columns = [], [column("f1", j) for j in (1, 2, 3)]
    for i in range(3):
        for j in range(3):
            body.append(Assignment(f"h_{i + 1}{j + 1}", sp.Add(*(columns[m][i] * rates[m, j] for m in range(3)))))
    for index, (i, j) in enumerate(VOIGT, 1):
        value = sp.Add(*(element(f"h_{i + 1}{m + 1}") * columns[m][j] for m in range(3)))
        body.append(Assignment(f"y_rate({index})", value))
    return body


def counted_stage(scene: Scene) -> Stage:
    """F Cdot F^T of the rates that J2 counts in the increment that passes the lock: those through the thickness."""
    z, p2, p3 = (column("f1", j) for j in scene.axes)
    rates = [element(f"cdot({place(scene.axes[i - 1], scene.axes[2])})") for i in (1, 2, 3)]
    body = [Assignment(f"v_{i + 1}", z[i] * rates[0] + p2[i] * rates[1] + p3[i] * rates[2] / 2) for i in range(3)]
    v = [element(f"v_{i}") for i in (1, 2, 3)]
    body += [Assignment(f"y_counted({n})", p3[i] * v[j] + v[i] * p3[j]) for n, (i, j) in enumerate(VOIGT, 1)]
    return make_stage("counted", "Rate through the thickness in space", "15, 16", "f1 cdot", "y_counted", body, sharing="none",
                      formula=("2 sym[(F N) v], v = Cdot_NN F N/2 + Cdot_nN F n + Cdot_tN F t",))  # fmt: skip
