"""Commands that show programs, parameters and recordings: check, params, report, plot."""
