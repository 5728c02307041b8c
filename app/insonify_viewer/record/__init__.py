"""The record: waterfall, echo of one ping, measuring, comparison."""
