"""One page, one style sheet, one figure style, one table, one progress bar: what every report is made of."""
