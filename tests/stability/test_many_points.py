"""Many points under Abaqus's rules: the element, the iteration's rules, and small meshes with their verdicts."""

from dataclasses import replace

import numpy as np
import pytest

from planting import ERRORS, Alteration, insert
from plyflow.case.case import law_parameters
from plyflow.evidence.stability.cells import Check, Verdict
from plyflow.evidence.stability.many_points import Analysis, Rules, Run
from plyflow.evidence.stability.plane_mesh import Array, Mesh, block, series
from plyflow.evidence.stability.scattered import COLUMN, in_series, mesh, pressed, scattered
from plyflow.evidence.stability.subject import Subject
from plyflow.law import integrate

WIDTH = Check("Many points", "a mesh", "width", 5e-4)
SERIES = Check("Many points", "series", "ratio", 1.1)
PART = (4, 2, 1, 1e3)
SCENE = "bdf1"


def planted_subject(error: str | Alteration) -> Subject:
    """Sources with an error in them."""
    return Subject(quick=True, edit=ERRORS[error] if isinstance(error, str) else error)


def analysis(subject: Subject, body: Mesh, **rules: float) -> Analysis:
    """A mesh of equal points at the start of the programme."""
    library, manifest = subject.scene(SCENE)
    props = subject.props(subject.values(COLUMN, kappa=1e3))
    given = replace(Rules(), **rules)  # type: ignore[arg-type]
    return Analysis(library, body, props, len(manifest["statev"]), COLUMN.case().load_programme, given)


def error_of_the_slope(subject: Subject, body: Mesh) -> float:
    """Stiffness of a distorted mesh beside central differences of its forces, relative to its largest entry."""
    one, random = analysis(subject, body), np.random.default_rng(3)
    size = 1e-3 * body.height / len(body.elements)
    place = size * random.uniform(-1.0, 1.0, body.ties.shape[1])

    def forces(moved: Array) -> Array:
        return np.asarray(one._system(moved, 1.0)[2])

    slope = np.asarray(one._system(place, 1.0)[3].toarray())  # type: ignore[attr-defined]
    step = 1e-5 * size
    steps = step * np.eye(len(place))
    wanted = np.stack([(forces(place + e) - forces(place - e)) / (2.0 * step) for e in steps], axis=1)
    return float(np.abs(slope - wanted).max() / np.abs(wanted).max())


@pytest.mark.parametrize("body", [block(2, 2), block(2, 1, sticking=True), series(2)], ids=["block", "sticking", "series"])
def test_the_stiffness_is_the_derivative_of_the_forces(subject: Subject, body: Mesh) -> None:
    """To the rounding of differences in a law as stiff as its power is small."""
    assert error_of_the_slope(subject, body) < 1e-5


def test_the_derivative_sees_a_tangent_half_a_percent_off() -> None:
    assert error_of_the_slope(planted_subject("a tangent half a percent off"), block(2, 2)) > 1e-3


def test_equal_points_end_as_the_law(subject: Subject) -> None:
    """Four elements of equal points: the law's thickness to the 0.2 to 0.5 % that so few increments of bdf1 leave, its width."""
    run = analysis(subject, block(2, 2)).run()
    values = subject.values(COLUMN)
    case = COLUMN.case()
    law = integrate(law_parameters(values), case.load_programme, np.array([case.load_programme.end]))
    assert run.finished and run.message == ""
    assert run.plate == pytest.approx(float(law.thickness_ratio[-1]), abs=5e-3)
    assert run.width == pytest.approx(np.full(16, np.exp(-values["eps_lock"])), rel=3e-4)
    assert run.thickness == pytest.approx(np.full(16, run.plate), rel=1e-6)
    assert run.increments == len(run.history) and run.iterations > run.increments


def test_an_attempt_that_the_material_gives_up_is_one_of_five() -> None:
    """As IA of *CONTROLS: five attempts after the first, each the part that PNEWDT asked for."""
    asks = insert(r"IF \(ifault /= 0\) CALL pf_", "PNEWDT = 0.5d0")
    run = analysis(planted_subject(asks), block(1, 1)).run()
    assert not run.finished
    assert run.increments == 0
    assert run.cutbacks == {"material": 6}
    assert run.message == "material at 0 s, 5 attempts"


def test_more_increments_than_allowed_end_the_run(subject: Subject) -> None:
    run = analysis(subject, block(1, 1), increments=3).run()
    assert (run.finished, run.increments) == (False, 3)
    assert run.message.startswith("too many increments")


def test_the_test_of_the_correction_is_off_unless_asked_for(subject: Subject) -> None:
    """Asked for, a last correction of more than a hundredth of the increment is followed by another iteration."""
    assert Rules().correction == np.inf
    runs = [analysis(subject, block(1, 1), correction=bound).run() for bound in (np.inf, 1e-2, 1e-6)]
    assert all(run.finished for run in runs)
    assert runs[0].iterations < runs[1].iterations < runs[2].iterations


def test_constants_are_scattered_evenly_and_the_same_on_every_run(subject: Subject) -> None:
    names = [p["name"] for p in subject.scene(SCENE)[1]["props"]]
    props = subject.props(subject.values(COLUMN))
    one, again, other = (scattered(props, names, 400, 0.03, seed) for seed in (1, 1, 2))
    assert one.tobytes() == again.tobytes() != other.tobytes()
    ratio = one / props
    drawn = [names.index(name) for name in ("k", "h0")]
    assert np.delete(ratio, drawn, axis=1) == pytest.approx(1.0, abs=0)
    assert 0.97 <= ratio[:, drawn].min() < 0.971 and 1.029 < ratio[:, drawn].max() <= 1.03
    assert abs(np.corrcoef(ratio[:, drawn].T)[0, 1]) < 0.15


def test_a_mesh_finishes_at_the_width_of_its_lock(subject: Subject) -> None:
    outcome = mesh(WIDTH, subject, SCENE, "-0.0593", PART, 1)
    assert outcome.verdict is Verdict.HOLDS, outcome.reason
    assert float(outcome.details["increments"]) <= 90
    assert outcome.details["cutbacks"] == "none"


@pytest.mark.parametrize(
    ("error", "said"),
    [("no widening at the lock", "above"), ("stage by the start", "above"), ("a viscous stress that drives", "stopped")],
)
def test_a_mesh_sees_an_error_of_the_lock(error: str, said: str) -> None:
    """Bleed rates counted from C0 leave the ply 0.6 % too narrow; a viscous stress of the wrong sign has no solution."""
    outcome = mesh(WIDTH, planted_subject(error), SCENE, "-0.0593", PART, 1)
    assert outcome.verdict is Verdict.FAILS
    assert said in outcome.reason


def test_points_in_series_take_the_increments_of_one(subject: Subject) -> None:
    outcome = in_series(SERIES, subject, SCENE, 10)
    assert outcome.verdict is Verdict.HOLDS, outcome.reason


def test_a_part_is_pressed_as_asked(subject: Subject) -> None:
    """`corrected` and the eps_lock of A.1 reach the run."""
    runs: list[Run] = [
        pressed(subject, SCENE, block(1, 1), 0.01, 1, {"kappa": 1e3, "eps_lock": -0.0593}, corrected=corrected)[0]
        for corrected in (False, True)
    ]
    assert runs[0].iterations < runs[1].iterations
    assert pressed(subject, SCENE, block(1, 1), 0.01, 1, {"kappa": 1e3})[1] == subject.values(COLUMN)["eps_lock"]
