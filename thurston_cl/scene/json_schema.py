"""The JSON Schema of scenes, as editors read it."""

from typing import Any, ClassVar

from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue
from pydantic_core import core_schema

from .schema import FORMAT_VERSION, Scene
from .values import PARAM_PATTERN


class _Draft7(GenerateJsonSchema):
    """Writes draft 7, for yaml-language-server, with `$name` wherever a number or a choice may stand."""

    _PARAM: ClassVar[JsonSchemaValue] = {"type": "string", "pattern": PARAM_PATTERN}

    def float_schema(self, schema: core_schema.FloatSchema) -> JsonSchemaValue:
        return {"anyOf": [super().float_schema(schema), self._PARAM]}

    def int_schema(self, schema: core_schema.IntSchema) -> JsonSchemaValue:
        return {"anyOf": [super().int_schema(schema), self._PARAM]}

    def literal_schema(self, schema: core_schema.LiteralSchema) -> JsonSchemaValue:
        return {"anyOf": [{"enum": list(schema["expected"])}, self._PARAM]}

    def dict_schema(self, schema: core_schema.DictSchema) -> JsonSchemaValue:
        # The pattern of the names is all there is: other names are wrong.
        return {**super().dict_schema(schema), "additionalProperties": False}

    def tuple_schema(self, schema: core_schema.TupleSchema) -> JsonSchemaValue:
        # Vectors: draft 7 has no prefixItems, and all our fixed lists hold one kind of value.
        if schema.get("variadic_item_index") is not None:
            return super().tuple_schema(schema)
        items = schema["items_schema"]
        return {
            "type": "array",
            "items": self.generate_inner(items[0]),
            "minItems": len(items),
            "maxItems": len(items),
        }

    def nullable_schema(self, schema: core_schema.NullableSchema) -> JsonSchemaValue:
        # `X | None` means that the key may be left out; a scene never says null.
        return self.generate_inner(schema["schema"])

    def default_schema(self, schema: core_schema.WithDefaultSchema) -> JsonSchemaValue:
        return self.generate_inner(schema["schema"])

    def field_title_should_be_set(self, schema: Any) -> bool:
        return False


def scene_schema() -> dict[str, Any]:
    """The JSON Schema (draft 7) of a scene file, for editors."""
    raw = Scene.model_json_schema(
        by_alias=True, ref_template="#/definitions/{model}", schema_generator=_Draft7, mode="validation"
    )
    definitions = raw.pop("$defs")
    return {
        "$schema": "http://json-schema.org/draft-07/schema#",
        "$id": f"thurston-scene-{FORMAT_VERSION}",
        **_refs_alone(raw),
        "title": "A scene of thurston_cl",
        "definitions": _refs_alone(definitions),
    }


def _refs_alone(schema: Any) -> Any:
    """Draft 7 ignores what stands beside a $ref; wrap the $ref so that descriptions are kept."""
    if isinstance(schema, list):
        return [_refs_alone(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    if "$ref" in schema and len(schema) > 1:
        rest = {key: value for key, value in schema.items() if key != "$ref"}
        return {"allOf": [{"$ref": schema["$ref"]}], **_refs_alone(rest)}
    return {key: _refs_alone(value) for key, value in schema.items()}
