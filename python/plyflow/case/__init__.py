"""The one-dimensional law as a tool: measured or named loads, many cases at once, comparison laws, synthetic tests."""
