"""Dotted paths of fields, checked against the declarations rather than against one scene."""

from __future__ import annotations

from pydantic import BaseModel

from insonify.scene.kinds import models_of


def is_field(root: type[BaseModel], path: str) -> bool:
    """Whether a dotted path leads to a field of a declaration, for some choice of the kinds on its way."""
    models: tuple[type[BaseModel], ...] = (root,)
    known = False
    for step in path.split("."):
        if step.isdigit() and known:
            continue
        holders = tuple(model for model in models if step in model.model_fields)
        known = bool(holders)
        if not known:
            return False
        models = tuple(child for model in holders for child in models_of(model, step))
    return known
