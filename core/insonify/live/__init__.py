"""A tow in real time: paced pings of one towfish or several, steered from outside, for survey programs."""
