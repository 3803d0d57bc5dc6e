"""What a host takes for granted of a UMAT beside DDSDDE, check by check, each with a verdict and what to do."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from plyflow.diagnose.calls import Increment, Subject, bits, path_of, refused, rotated, strain_and_rotation
from plyflow.diagnose.case import Case
from plyflow.diagnose.check import Diagnosis
from plyflow.diagnose.cycle import created_energy
from plyflow.diagnose.statics import Statics
from plyflow.driver.points import call_points
from plyflow.umat.library import UmatLibrary
from plyflow.wording import count_text

Array = NDArray[np.float64]
Outcome = Literal["good", "look", "bad", "open"]
TURNS = Rotation.from_rotvec([[0.3, -1.1, 0.7], [2.0, 1.0, -0.5]]).as_matrix()
OBJECTIVE = 1e-6  # of the largest stress, far below any mistake
ROUNDINGS = 20.0  # of what the last bits of F do: a turn rounds F anew, and a stiff law makes much of it
THREAD_CALLS = 20_000


@dataclass(frozen=True)
class Verdict:
    """What a check says: good, look (allowed, but worth a look), bad or open (could not be judged), and what to do."""

    check: str
    outcome: Outcome
    found: str
    remedy: str = ""


Check = Callable[[Subject], Verdict]


def examine(library: UmatLibrary, case: Case, diagnosis: Diagnosis) -> list[Verdict]:
    """All verdicts on a UMAT along the path of a diagnosis, that on DDSDDE first."""
    temperature = case.setting("temperature")
    path = path_of(diagnosis.history)
    subject = Subject(library, case.setting("props"), temperature[-1] if temperature else 0.0, path)
    first = [_tangent(diagnosis)]
    return first + [check(subject) for check in CHECKS] if path else first


def _tangent(diagnosis: Diagnosis) -> Verdict:
    largest = f"within {diagnosis.worst.difference:.1e} of differences"
    if diagnosis.right:
        return Verdict("DDSDDE", "good", f"{largest} in {count_text(len(diagnosis.points), 'increment', 'increments')}")
    remedy = " or: ".join(diagnosis.mistakes) or "none of the common mistakes fits; look at the component named above"
    return Verdict("DDSDDE", "bad", f"up to {diagnosis.worst.difference:.2g} of its largest component off", remedy)


def _objectivity(subject: Subject) -> Verdict:
    """The first increment, whose state holds no tensors yet, seen after two turns."""
    one = subject.increments[0]
    plain = subject.call(one)
    scale = float(np.abs(plain.stress).max())
    apart = 0.0
    for turn in TURNS:
        seen = subject.call(one.turned(turn))
        if refused(plain) or refused(seen) or scale == 0.0:
            return Verdict("objectivity", "open", "no stress to turn: the first increment gives none, or is refused")
        apart = max(apart, float(np.abs(seen.stress - rotated(plain.stress, turn)).max()) / scale)
    if apart <= OBJECTIVE or apart <= ROUNDINGS * _rounding(subject, one, plain.stress) / scale:
        return Verdict("objectivity", "good", f"a turned deformation gives the turned stress, to {apart:.0e}")
    return Verdict(
        "objectivity", "bad", f"turned rigidly, the stress changes by {apart:.1g} of itself",
        "work with C = F^T F or b = F F^T of DFGRD1, or with DSTRAN and a law that is isotropic; a law with directions in the "
        "global axes needs *ORIENTATION, so that Abaqus turns them",
    )  # fmt: skip


def _rounding(subject: Subject, one: Increment, stress: Array) -> float:
    """How far the stress moves when each component of the deformation gradients moves by half a unit in the last place of 1."""
    by = np.spacing(1.0) * (2.0 * np.random.default_rng(1).integers(0, 2, (8, 2, 3, 3)) - 1.0) / 2.0
    moved = (subject.call(replace(one, start=one.start + start, end=one.end + end)).stress for start, end in by)
    return max(float(np.abs(there - stress).max()) for there in moved)


def _again(subject: Subject) -> Verdict:
    """Each increment of the path, again after all others."""
    first, second = ([bits(subject.call(one)) for one in subject.increments] for _ in range(2))
    if first == second:
        return Verdict("called again", "good", "the same bits")
    count = sum(a != b for a, b in zip(first, second, strict=True))
    return Verdict(
        "called again", "bad", f"{count} of {len(first)} increments give other results when they are called again",
        "Abaqus calls several times an increment and point by point: keep nothing but STATEV between calls, set every local "
        "variable before it is used",
    )  # fmt: skip


def _threads(subject: Subject) -> Verdict:
    """Many points on two threads and on one."""
    many = [subject.increments[i % len(subject.increments)] for i in range(THREAD_CALLS)]
    arrays = [np.array([getattr(one, name) for one in many]) for name in ("start", "end", "size", "state", "stress")]
    start, end, size, state, stress = arrays
    one, two = (
        call_points(
            subject.library, subject.props, start, end, size, state, stress, temperature=subject.temperature, threads=threads
        )
        for threads in (1, 2)
    )
    same = [a.tobytes() == b.tobytes() for a, b in ((one.stress, two.stress), (one.statev, two.statev), (one.ddsdde, two.ddsdde))]
    if all(same):
        return Verdict("two threads", "good", f"the same bits in {THREAD_CALLS} calls")
    return Verdict(
        "two threads", "bad", "on two threads the results are others than on one",
        "no SAVE, COMMON, DATA or module variable that is written, no fixed file unit; compile with -frecursive or -auto",
    )  # fmt: skip


def _cutback(subject: Subject) -> Verdict:
    """Half an increment, in a fresh copy of the library and in one that has tried the whole of it before."""
    one = subject.increments[-1]
    half = replace(one, end=one.start + 0.5 * (one.end - one.start), size=0.5 * one.size)
    far = replace(one, end=one.start + 2.0 * (one.end - one.start), size=2.0 * one.size)
    results = []
    with tempfile.TemporaryDirectory() as folder:
        for number, before in enumerate(((), (far, one))):
            copy = Path(shutil.copy2(subject.library.path, Path(folder) / f"copy{number}.so"))
            library = UmatLibrary(copy)
            for tried in before:
                subject.call(tried, library)
            results.append(bits(subject.call(half, library)))
    if results[0] == results[1]:
        return Verdict("after a cutback", "good", "half the increment gives the same bits as if the whole had not been tried")
    return Verdict(
        "after a cutback", "bad", "half an increment depends on whether the whole was tried before",
        "what an attempt that failed leaves behind must not count: only STATEV is set back by the host",
    )  # fmt: skip


def _failure(subject: Subject) -> Verdict:
    """An end that is turned inside out, and one that is all but flat."""
    one, said = subject.increments[-1], []
    ends = {"det F < 0": np.diag([1.0, 1.0, -1.0]) @ one.end, "thickness 1e-8": np.diag([1.0, 1.0, 1e-8]) @ one.end}
    for name, end in ends.items():
        before = replace(one, end=end)
        answer = subject.call(before)
        finite = bool(np.isfinite(answer.stress).all())
        touched = not (np.array_equal(answer.statev, one.state) and np.allclose(answer.stress, _given(before), rtol=0.0, atol=0.0))
        if refused(answer) and touched:
            return Verdict(
                "failure", "bad", f"at {name} it refuses the increment but has changed STRESS or STATEV",
                "set PNEWDT and RETURN before anything is written, or work on copies: not every host sets STATEV back",
            )  # fmt: skip
        if not refused(answer) and finite and name == "det F < 0":
            return Verdict(
                "failure", "look", "a deformation that is turned inside out gets a finite stress and no complaint",
                "IF (det(DFGRD1) <= 0) set PNEWDT = 0.25 and RETURN; a law in DSTRAN alone cannot see it",
            )  # fmt: skip
        passed = "done" if finite else "not finite, which hosts see"
        said.append(f"{name}: {'refused, all as it came' if refused(answer) else passed}")
    return Verdict("failure", "good", "; ".join(said))


def _given(one: Increment) -> Array:
    """STRESS as `Subject.call` hands it over."""
    return rotated(one.stress, strain_and_rotation(one.start, one.end)[1])


def _nan(subject: Subject) -> Verdict:
    one = subject.increments[-1]
    broken = one.end.copy()
    broken[2, 2] = np.nan
    answer = subject.call(replace(one, end=broken))
    if refused(answer) or not np.isfinite(answer.stress).all():
        how = "refused" if refused(answer) else "the stress is not finite, which hosts see"
        return Verdict("NaN in", "good", f"NaN in DFGRD1: {how}")
    return Verdict(
        "NaN in", "bad", "NaN in DFGRD1 and DSTRAN gives a finite stress",
        "MAX, MIN and comparisons swallow NaN: write tests as IF (.NOT. X > 0), so that NaN fails them",
    )  # fmt: skip


def _unused(subject: Subject) -> Verdict:
    """Constants that change nothing, neither by a hundredth nor by one."""
    usual = [bits(subject.call(one)) for one in subject.increments]
    idle = []
    for place, value in enumerate(subject.props):
        for other in (value * 1.01 if value else 0.01, value + 1.0):
            props = [*subject.props[:place], other, *subject.props[place + 1 :]]
            if any(bits(subject.call(one, props=props)) != own for one, own in zip(subject.increments, usual, strict=True)):
                break
        else:
            idle.append(place + 1)
    if not idle:
        return Verdict("PROPS", "good", f"all {len(subject.props)} change something on this path" if subject.props else "none given")
    listed = ", ".join(map(str, idle))
    return Verdict("PROPS", "look", f"PROPS {listed}: without effect on this path", "drive a path that needs them, or leave them out")


def _kept(subject: Subject) -> Verdict:
    statics = Statics(subject.library)
    if not statics.known:
        return Verdict("SAVE and COMMON", "open", "readelf is missing, or the library has no symbols (stripped)")
    before = statics.contents()
    for one in subject.increments:
        subject.call(one)
    written = [one for one, old, new in zip(statics.found, before, statics.contents(), strict=True) if old != new]
    if not written:
        constants = f"; {len(statics.found)} that are only read (DATA)" if statics.found else ""
        return Verdict("SAVE and COMMON", "good", f"no variable outlives a call and is written{constants}")
    names = ", ".join(f"{'COMMON or module variable' if one.common else 'SAVE'} {one.name}" for one in written)
    return Verdict(
        "SAVE and COMMON", "bad", f"calls write {names}",
        "such memory is shared by all points and threads and is not set back after a cutback: use STATEV or plain locals",
    )  # fmt: skip


def _energy(subject: Subject) -> Verdict:
    found = created_energy(subject)
    if found is None:
        return Verdict("energy", "open", "no closed cycle could be driven: its increments are refused")
    created, scale = found
    if not created:
        return Verdict("energy", "good", "no energy comes out of closed cycles")
    return Verdict(
        "energy", "bad", f"a closed cycle gives back {created / scale:.1g} of the largest work done in it",
        "derive the elastic stress from one potential of C; rates (Jaumann, Green-Naghdi) with constant moduli make energy at "
        "large strain",
    )  # fmt: skip


CHECKS: tuple[Check, ...] = (_objectivity, _again, _threads, _cutback, _failure, _nan, _energy, _unused, _kept)
