"""What every report is made of: one page with one style sheet, one table, one figure style, one progress bar."""
