"""The audit run: consequences, machine code, and reports in a terminal, as Markdown, JSON and HTML."""
