"""The receiver: from the traced intensities of an ideal pulse to the intensities of the record."""

from insonify.receiver.detection import receive, record_echoes
from insonify.receiver.reception import Reception, Traced, make_reception, prepare_reception

__all__ = ["Reception", "Traced", "make_reception", "prepare_reception", "receive", "record_echoes"]
