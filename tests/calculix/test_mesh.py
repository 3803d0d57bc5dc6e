"""The regular meshes: counts, faces, shape functions of the comparison with the driver."""

from __future__ import annotations

import numpy as np
import pytest

from plyflow.hosts.calculix.compare import deformation_gradients
from plyflow.hosts.mesh import Mesh


def test_elements_are_right_handed_and_fill_the_block() -> None:
    mesh = Mesh()
    mesh.add_block("A", (2, 3, 4), (2.0, 1.5, 1.0), (5.0, 0.0, -1.0))
    assert (len(mesh.nodes), len(mesh.elements)) == (3 * 4 * 5, 24)
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
            elements, _ = mesh.face("A", axis, side)
            assert len(elements) == 4
            assert len(mesh.face_nodes("A", axis, side)) == 9
            assert {mesh.nodes[node][axis] for node in mesh.face_nodes("A", axis, side)} == {float(side)}


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
