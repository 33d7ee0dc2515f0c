"""``python -m moseg_core`` is ``moseg``."""

from __future__ import annotations

from moseg_core.cli import main

if __name__ == "__main__":
    main()
