"""The receiver: from the traced intensities of an ideal pulse to the intensities of the record."""

from insonify.receiver.reception import Reception, assemble, prepare_setup, receive, record_echoes
from insonify.receiver.stage import Traced

__all__ = ["Reception", "Traced", "assemble", "prepare_setup", "receive", "record_echoes"]
