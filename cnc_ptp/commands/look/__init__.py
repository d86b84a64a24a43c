"""Commands that show what there is: check, params, report, plot."""
