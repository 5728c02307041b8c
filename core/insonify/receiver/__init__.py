"""The receiver: from the traced intensities of an ideal pulse to the intensities of the record."""

from insonify.receiver.reception import Reception, Traced, make_reception, prepare_reception, receive, record_echoes

__all__ = ["Reception", "Traced", "make_reception", "prepare_reception", "receive", "record_echoes"]
