"""Where things of a scene stand: points, isometries and the camera's frame, worked out by the kernels in
double.
"""

import copy
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from thurston_cl.geometry import Geometry
from thurston_cl.lattice import Lattice
from thurston_cl.lattice.isometry import (
    act,
    compose,
    identity,
    on_model,
    origin,
    snap,
    stabilizer,
    vector_map,
)
from thurston_cl.models import LEFT_INVARIANT
from thurston_cl.scene import schema

Array = NDArray[np.float64]
# Below this sine of their angle, the direction of view and up leave no plane for the picture's sides.
PARALLEL = 1e-9
# Coordinates, and e^|z| in sol, beyond this have lost all digits of what is near them: in h3 and along z in
# sol, 27 from the origin.
FARTHEST = 1e12
# There is no frame right at the antipode of the origin of s3: a camera there stands so far beside it, towards
# x. That is far below what can be seen, and its square is a normal number of single precision.
ANTIPODE_OFFSET = 1e-12
X_AXIS = np.array([1.0, 0.0, 0.0])
Z_AXIS = np.array([0.0, 0.0, 1.0])
# All rotations of sol about the origin: none, and half turns about [0, 0, 1], [1, 1, 0] and [1, -1, 0].
SOL_TURNS = np.array(
    [
        [[1.0, 0, 0], [0, 1, 0], [0, 0, 1]],
        [[-1, 0, 0], [0, -1, 0], [0, 0, 1]],
        [[0, 1, 0], [1, 0, 0], [0, 0, -1]],
        [[0, -1, 0], [-1, 0, 0], [0, 0, -1]],
    ]
)


class Placement:
    """Places things in one geometry."""

    def __init__(self, geometry: Geometry) -> None:
        self.geometry = geometry

    def point(self, where: "schema.ModelPoint | tuple[float, float, float]") -> Array:
        """The point (4,) that a scene means: flowed to from the origin, or given by its coordinates."""
        name = self.geometry.name
        if isinstance(where, schema.ModelPoint):
            point = on_model(name, np.array([where.model]))[0]
        else:
            vector = np.asarray(where, dtype=np.float64)
            length = float(np.linalg.norm(vector))
            if length == 0:
                return origin(name)
            point = self.geometry.flow(vector / length, length)[0][0]
        self.check_near(point)
        return point

    def check_near(self, point: Array) -> None:
        """ValueError for a point (4,) next to which coordinates have no digits left."""
        height = abs(point[2]) if self.geometry.name == "sol" else 0.0
        if not (np.all(np.abs(point) < FARTHEST) and height < np.log(FARTHEST)):
            raise ValueError("this point is too far away to be computed with")

    def isometry(
        self, where: "schema.ModelPoint | tuple[float, float, float]", turns: Iterable[schema.Rotation] = ()
    ) -> Array:
        """The isometry (n,n) that turns about the origin and then carries the origin to a point."""
        name = self.geometry.name
        matrix = identity(name)
        for turn in turns:
            axis = np.asarray(turn.axis, dtype=np.float64)
            rotation = Rotation.from_rotvec(axis / np.linalg.norm(axis) * turn.angle).as_matrix()
            matrix = compose(name, stabilizer(name, snap(rotation)), matrix)
        translation = self.geometry.translation_matrix(self.point(where))[0]
        if np.linalg.det(translation) < 0:
            # The antipode of the origin of s3: any rotation that leads there will do, a reflection will not.
            translation = np.diag([-1.0, 1.0, 1.0, -1.0])
        return snap(compose(name, translation, matrix))

    def vectors(self, point: Array) -> Array:
        """The frame at a point (4,) as vectors (3,4) in the form that the kernels march with."""
        if self.geometry.name in LEFT_INVARIANT:
            return np.eye(3, 4)
        return self.geometry.velocity(point, np.eye(3))

    def turn(self, start: Iterable[float], goal: Iterable[float]) -> Array:
        """The smallest rotation (n,n) about the origin that turns one axis to a direction. In the fibred
        geometries it has to keep the fibre: both are along it, or both across. In sol both are vertical, or
        both along x or y.
        """
        a, b = (np.asarray(tuple(v), dtype=np.float64) / np.linalg.norm(tuple(v)) for v in (start, goal))
        if self.geometry.name == "sol":
            return stabilizer("sol", SOL_TURNS[np.argmax(SOL_TURNS @ a @ b)])
        axis, cosine = np.cross(a, b), float(a @ b)
        sine = float(np.linalg.norm(axis))
        if sine > 0:
            matrix = Rotation.from_rotvec(axis / sine * np.arctan2(sine, cosine)).as_matrix()
        else:
            # A half turn may be about any axis across: take a coordinate axis.
            across = X_AXIS if abs(a[0]) < abs(a[2]) else Z_AXIS
            matrix = np.eye(3) if cosine > 0 else 2.0 * np.outer(across, across) - np.eye(3)
        return stabilizer(self.geometry.name, snap(matrix))


class CameraFrame:
    """A camera: its point (4,) and the directions right, up and forward (rows of `frame`, (3,3)) there."""

    def __init__(self, camera: schema.Camera, place: Placement) -> None:
        self._place = place
        self._element = identity(place.geometry.name)
        self.point = place.point(camera.at)
        if place.geometry.name == "s3" and self.point[3] < 0 and not self.point[:3].any():
            self.point[0] = ANTIPODE_OFFSET
        forward = np.asarray(camera.look.along, dtype=np.float64)
        if camera.look.to is not None:
            directions, lengths = place.geometry.geodesics(place.point(camera.look.to), 1, base=self.point)
            if lengths[0, 0] == 0:
                raise ValueError("the camera stands at the point it looks at")
            forward = directions[0, 0]
        forward = forward / np.linalg.norm(forward)
        right = np.cross(forward, np.asarray(camera.look.up, dtype=np.float64))
        if np.linalg.norm(right) <= PARALLEL * np.linalg.norm(camera.look.up):
            raise ValueError("the direction of view is parallel to up")
        right = right / np.linalg.norm(right)
        self.frame = np.stack([right, np.cross(right, forward), forward])
        for step in camera.move:
            self._move(step.kind, step.amount)

    def _move(self, kind: str, amount: float) -> None:
        right, up, forward = self.frame
        along = {"right": right, "up": up, "forward": forward}
        if kind in along:
            geometry, point = self._place.geometry, self.point
            self.point = geometry.flow(along[kind], amount, base=point)[0][0]
            self.frame = self.frame @ geometry.transport(along[kind], amount, base=point)[0].T
        else:
            axis = {"yaw": up, "pitch": right, "roll": forward}[kind]
            self.frame = self.frame @ Rotation.from_rotvec(axis * amount).as_matrix().T
        self.frame = self.frame / np.linalg.norm(self.frame, axis=1, keepdims=True)

    def eye(self, reach: float) -> "CameraFrame":
        """The camera of an eye, `reach` to the right of this one along the geodesic there, with the frame
        transported along. ValueError for eyes that are too far away.
        """
        eye = copy.copy(self)
        if reach != 0:
            eye._move("right", reach)
            self._place.check_near(eye.point)
        return eye

    def carry(self, lattice: Lattice) -> bool:
        """Lead the camera into the cell by a group element; False where it finds no way there."""
        point, element, ok = lattice.teleport(self.point[None])
        # In the frames at both ends the element is a rotation or a reflection.
        carried = self._place.vectors(self.point) @ vector_map(lattice.geometry, element[0]).T
        turn = np.linalg.lstsq(self._place.vectors(point[0]).T, carried.T, rcond=None)[0]
        self.point, self.frame, self._element = point[0], self.frame @ turn.T, element[0]
        return bool(ok[0])

    def carry_along(self, point: Array) -> Array:
        """A point (4,) moved by the group element that led the camera into the cell."""
        return act(self._place.geometry.name, self._element, point)
