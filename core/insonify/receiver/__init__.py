"""The receiver: from what a tracer hears to what the record shows."""

from insonify.receiver.reception import Reception, make_reception, receive, record_echoes

__all__ = ["Reception", "make_reception", "receive", "record_echoes"]
