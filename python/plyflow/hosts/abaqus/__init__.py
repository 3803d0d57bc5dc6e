"""Abaqus decks for a scene: cards, single-element jobs and a laminate, with their check."""
