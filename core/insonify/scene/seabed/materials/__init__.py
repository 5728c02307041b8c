"""Materials of bed and targets: named ones, their scattering parameters, and one file a kind of map."""

from insonify.scene.seabed.materials.base import MATERIAL_MAPS, AnyMaterialMap, Cells, MaterialMap
from insonify.scene.seabed.materials.catalogue import MATERIALS, NamedMaterial
from insonify.scene.seabed.materials.composite import CompositeMap
from insonify.scene.seabed.materials.reflectivity import Reflectivity
from insonify.scene.seabed.materials.uniform import Material

__all__ = [
    "MATERIALS",
    "MATERIAL_MAPS",
    "AnyMaterialMap",
    "Cells",
    "CompositeMap",
    "Material",
    "MaterialMap",
    "NamedMaterial",
    "Reflectivity",
]
