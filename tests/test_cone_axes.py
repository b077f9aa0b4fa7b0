"""Figure 16: the cone axes of the library, and what they do to the picture of a ball behind them."""

import numpy as np
import pytest

import thurston_cl as tc
from thurston_cl import lattice
from thurston_cl.scene.manifold import MatrixLattice

# Scene, cone angle in degrees, and how many pictures of the red ball stand beside the axis.
SCENES = [("h3/cone-axis-double-image", 320, 2), ("h3/cone-axis-hidden-ball", 400, 0)]
# The scenes give twelve digits of numbers up to 11, and walls are carried by products of two of them.
DIGITS = 1e-6
RUBY = 5
# Between the red balls around this axis, which are nearer, and those around others.
NEAR = 2.5


@pytest.mark.parametrize(("name", "degrees", "pictures"), SCENES)
def test_eight_edges_make_one_axis(name: str, degrees: float, pictures: int) -> None:
    given = tc.load_scene(name).manifold
    assert isinstance(given, MatrixLattice)
    (axis,) = lattice.edge_cycles(given.lattice("h3"))
    assert sorted(axis.edges) == list(range(8))
    assert np.degrees(axis.angle) == pytest.approx(degrees, abs=DIGITS)
    assert axis.order is None


@pytest.mark.parametrize(("name", "degrees", "pictures"), SCENES)
def test_a_ball_behind_the_axis_is_seen_twice_or_not_at_all(name: str, degrees: float, pictures: int) -> None:
    channels = tc.render(tc.load_scene(name), size=(240, 136), samples=1, lanes=1).channels
    red = ((channels["object"] == RUBY) & (channels["depth"] < NEAR)).any(axis=0)
    begins = np.flatnonzero(red & ~np.roll(red, 1))
    assert len(begins) == pictures
    # One on either side of the column, alike.
    assert np.count_nonzero(red[:120]) == pytest.approx(np.count_nonzero(red[120:]), abs=2)
