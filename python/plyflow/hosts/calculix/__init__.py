"""CalculiX as a finite-element host: its build with external materials, faces of a scene, runs, comparison."""
