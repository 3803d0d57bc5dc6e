"""What times were taken on and with."""

from __future__ import annotations

import os
import platform
from pathlib import Path
from typing import Any

import numpy as np

from plyflow.provenance import package_version
from plyflow.umat.compile import FLAGS, compiler_version


def machine() -> dict[str, Any]:
    """Processor, system, compiler and versions, ready for JSON."""
    info = Path("/proc/cpuinfo")
    lines = info.read_text(encoding="utf-8").splitlines() if info.exists() else []
    models = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return {
        "processor": models[0] if models else platform.processor() or "unknown",
        "cores": os.cpu_count(),
        "load_average": os.getloadavg()[0] if hasattr(os, "getloadavg") else "unknown",
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "numpy": np.__version__,
        "compiler": compiler_version(),
        "flags": " ".join(FLAGS),
        "driver_flags": "-O3 -flto",
        "plyflow": package_version(),
    }
