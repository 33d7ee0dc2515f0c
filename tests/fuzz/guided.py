"""Fuzzing guided by coverage, with atheris: bytes that reach new lines are kept and changed again.

::

    pip install atheris
    python -m tests.fuzz.guided "ply, text" corpus/ -max_total_time=600

begins with all small cases of the format. What falls short is written into ``finds`` in the working
folder, one file for each message. atheris is no requirement of the tests: what it finds is mended
and becomes a case or a test of its module.
"""

from __future__ import annotations

import hashlib
import re
import sys
import tempfile
from pathlib import Path

from tests.fuzz.children import ROOT
from tests.fuzz.everything import all_cases

_LONGEST = 4096
_WATCHED = ("moseg_core.io.", "moseg_core.language.", "moseg_core.problem.")
"""Where lines are counted: packages that read. Kernels must not be, which numba compiles."""


def _unwatched() -> list[str]:
    """All other modules of the core; atheris wants each by its full name."""
    package = ROOT / "moseg_core"
    names = [
        ".".join(file.relative_to(ROOT).with_suffix("").parts) for file in package.rglob("*.py")
    ]
    whole = [name.removesuffix(".__init__") for name in names]
    return [name for name in whole if not f"{name}.".startswith(_WATCHED)]


def main() -> None:
    import atheris

    format, corpus, *options = sys.argv[1:]
    include = ["moseg_core", "moseg_medical", "tomllib"]
    with atheris.instrument_imports(include=include, exclude=_unwatched()):
        from tests.fuzz.children import _warm_up
        from tests.fuzz.verdict import BAD, judge

        _warm_up()
    cases = [case for case in all_cases() if case.format == format]
    if not cases:
        known = ", ".join(sorted({case.format for case in all_cases()}))
        sys.exit(f"no format '{format}'; there are: {known}")
    suffix, task = next((c.suffix, c.task) for c in cases if c.kind == "untouched")
    kept = Path(corpus)
    kept.mkdir(parents=True, exist_ok=True)
    for case in cases:
        data = next(iter(case.files().values())) if case.kind not in ("large", "expansion") else b""
        if 0 < len(data) <= _LONGEST:
            (kept / hashlib.sha256(data).hexdigest()[:24]).write_bytes(data)
    folder = Path(tempfile.mkdtemp(prefix="moseg-guided-"))
    for name, data in next(c for c in cases if c.kind == "untouched").files().items():
        (folder / name).write_bytes(data)
    path = folder / f"case{suffix}"
    asked = {"path": str(path), "task": task, "expected": "either", "elements": (0, 1 << 62)}

    finds = Path("finds")
    finds.mkdir(exist_ok=True)

    def read(data: bytes) -> None:
        path.write_bytes(data)
        verdict = judge(asked | {"area": None})
        if verdict.outcome in BAD:
            said = re.sub(r"[^a-z ]+", " ", f"{verdict.outcome}: {verdict.said}"[:90].lower())
            name = "_".join(said.split())[:80]
            if not (finds / f"{name}.txt").exists():
                (finds / f"{name}{suffix}").write_bytes(data)
                (finds / f"{name}.txt").write_text(verdict.said)

    atheris.Setup([sys.argv[0], corpus, f"-max_len={_LONGEST}", "-timeout=30", *options], read)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
