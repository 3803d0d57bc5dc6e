"""A scene generated, compiled, loaded."""
