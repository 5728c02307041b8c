"""The tow: its line, and position and attitude of the sonar at every ping."""
