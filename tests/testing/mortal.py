"""A measure that takes its process with it."""

from __future__ import annotations

import os


def end(part):
    os._exit(1)
