"""Pictures between the rows of the parameters panel: curves of beams and pulse, and the spectrum of the bed."""
