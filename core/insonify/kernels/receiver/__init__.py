"""The receiver along a ping: the pulse spreads echoes over bins, and other sonars are received."""
