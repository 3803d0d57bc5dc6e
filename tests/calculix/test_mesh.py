"""The regular meshes: counts, faces, shape functions of the comparison with the driver."""

from __future__ import annotations

import numpy as np
import pytest

from plyflow.errors import InputError
from plyflow.hosts.abaqus.mesh import Mesh
from plyflow.hosts.calculix.compare import deformation_gradients


@pytest.mark.parametrize(("quadratic", "nodes", "per_element"), [(False, 3 * 4 * 2, 8), (True, 24 + 46, 20)])
def test_a_block_has_as_many_nodes_as_it_should(quadratic: bool, nodes: int, per_element: int) -> None:
    mesh = Mesh()
    mesh.add_block("A", (2, 3, 1), (2.0, 3.0, 1.0), quadratic=quadratic)
    assert len(mesh.nodes) == nodes
    assert len(mesh.elements) == 6
    assert all(len(set(element)) == per_element for element in mesh.elements.values())


def test_elements_are_right_handed_and_fill_the_block() -> None:
    mesh = Mesh()
    mesh.add_block("A", (2, 3, 4), (2.0, 1.5, 1.0), (5.0, 0.0, -1.0))
    volume = 0.0
    for nodes in mesh.elements.values():
        x = np.array([mesh.nodes[node] for node in nodes])
        edges = np.array([x[1] - x[0], x[3] - x[0], x[4] - x[0]])
        volume += np.linalg.det(edges)
    assert volume == pytest.approx(3.0)


def test_faces_and_their_nodes_lie_on_the_side_they_are_named_for() -> None:
    mesh = Mesh()
    mesh.add_block("A", (2, 2, 2), (1.0, 1.0, 1.0))
    for axis in range(3):
        for side in (0, 1):
            elements, _ = mesh.faces["A", axis, side]
            assert len(elements) == 4
            assert len(mesh.face_nodes("A", axis, side)) == 9
            assert {mesh.nodes[node][axis] for node in mesh.face_nodes("A", axis, side)} == {float(side)}


@pytest.mark.parametrize(("cells", "size"), [((0, 1, 1), (1.0, 1.0, 1.0)), ((1, 1, 1), (1.0, 0.0, 1.0))])
def test_a_block_of_nothing_is_refused(cells: tuple[int, int, int], size: tuple[float, float, float]) -> None:
    with pytest.raises(InputError, match="must all be positive"):
        Mesh().add_block("A", cells, size)


def test_a_name_is_given_once() -> None:
    mesh = Mesh()
    mesh.add_block("A", (1, 1, 1), (1.0, 1.0, 1.0))
    for again in (
        lambda: mesh.add_block("A", (1, 1, 1), (1.0, 1.0, 1.0)),
        lambda: mesh.add_quadrilateral("A", (1.0, 1.0)),
    ):
        with pytest.raises(InputError, match="a block 'A' already"):
            again()


def test_a_homogeneous_displacement_has_its_gradient_in_every_point() -> None:
    mesh, gradient = Mesh(), np.array([[0.1, 0.2, 0.0], [-0.3, 0.05, 0.1], [0.0, 0.4, -0.2]])
    mesh.add_block("A", (1, 1, 1), (2.0, 0.5, 3.0), (1.0, 1.0, 1.0))
    moved = np.array([[gradient @ mesh.nodes[node] for node in mesh.elements[1]]])
    assert deformation_gradients(mesh, 1, moved)[0] == pytest.approx(
        np.broadcast_to(np.eye(3) + gradient, (8, 3, 3)), abs=1e-14
    )


def test_points_are_in_calculix_order_first_axis_fastest() -> None:
    mesh = Mesh()
    mesh.add_block("A", (1, 1, 1), (1.0, 1.0, 1.0))
    moved = np.zeros((1, 8, 3))
    for row, node in enumerate(mesh.elements[1]):
        x, y, z = mesh.nodes[node]
        moved[0, row, 0] = 0.1 * x * y + 0.01 * x * z
    slopes = deformation_gradients(mesh, 1, moved)[0, :, 0, 0] - 1.0
    low, high = 0.5 - 0.5 / 3**0.5, 0.5 + 0.5 / 3**0.5
    expected = [0.1 * y + 0.01 * z for z in (low, high) for y in (low, high) for _ in (low, high)]
    assert slopes == pytest.approx(expected)
