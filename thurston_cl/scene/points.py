"""Points of a scene: a vector to flow along, or coordinates in the model."""

from collections.abc import Iterator
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, TypeAdapter, ValidationInfo

from thurston_cl.models import MODEL, off_model

from .base import Node, Problem, problem, shown
from .context import Context, context_of
from .values import Says, Vec3, Vec4

# How far a written point may be off the model: what six decimals leave.
_WRITTEN = 1e-5


class ModelPoint(Node):
    """A point given by its coordinates in the model of the geometry."""

    what = "a point"
    example = "{model: [0, 0, 0, 1]}"

    model: Vec4 = Field(
        description="Coordinates in the model: w = 1 in e3, nil and sol; x² + y² + z² + w² = 1 in s3; "
        "x² + y² + z² − w² = −1 with w > 0 in h3; x² + y² + z² = 1 in s2xe and "
        "x² + y² − z² = −1 with z > 0 in h2xe and sl2, where w is the place on the fiber."
    )

    def check(self, context: Context) -> Iterator[Problem]:
        if context.geometry is None:
            return
        off = off_model(context.geometry, *self.model)
        if abs(off) > _WRITTEN:
            rule = MODEL[context.geometry]
            yield Problem(("model",), f"this is not a point of the geometry, where {rule}")


_VEC3: TypeAdapter[tuple[float, float, float]] = TypeAdapter(Vec3)


def _point(value: Any, info: ValidationInfo) -> Any:
    if isinstance(value, dict):
        return ModelPoint.model_validate(value, context=context_of(info))
    if isinstance(value, (list, tuple)):
        return _VEC3.validate_python(value)
    if not isinstance(value, ModelPoint):
        raise problem(f"expected a point, found {shown(value)}", "write [x, y, z] or {model: [x, y, z, w]}")
    return value


Point = Annotated[
    Vec3 | ModelPoint,
    BeforeValidator(_point),
    Says("point: `[x, y, z]` or `{model: [x, y, z, w]}`"),
]
