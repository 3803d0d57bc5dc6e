"""What scenes generate, made once in a test run."""

from __future__ import annotations

import functools

from umatgen import pipeline

generate = functools.cache(pipeline.generate)
