"""Formats of side-scan and multibeam recordings that are known by name alone: another program converts them to XTF."""

from insonify.arrays import Dataset
from insonify.io.formats import FileFormat

Foreign = FileFormat[Dataset]
FISHFINDER = "export it as XTF, for example with SonarTRX or SonarWiz"
SURVEY = "export it as XTF, for example with SonarWiz or with the program that recorded it"

LOWRANCE: Foreign = FileFormat("Lowrance SLG", (".slg",), converter=FISHFINDER)
CERULEAN: Foreign = FileFormat("Cerulean SVLOG", (".svlog",), converter=FISHFINDER)
TELEDYNE: Foreign = FileFormat("Teledyne Reson s7k", (".s7k", ".7k"), converter=SURVEY)
KONGSBERG: Foreign = FileFormat("Kongsberg EM", (".all", ".kmall", ".wcd", ".kmwcd"), converter=SURVEY)
KLEIN: Foreign = FileFormat("Klein SDF", (".sdf",), converter=SURVEY)
MARINE_SONIC: Foreign = FileFormat("Marine Sonic MST", (".mst", ".sds"), converter=SURVEY)
GENERIC_SENSOR: Foreign = FileFormat("Generic Sensor Format", (".gsf",), converter=SURVEY)
