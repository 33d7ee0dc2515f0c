"""``moseg plugin new``: a bundle to begin with. Imports no bundle, only asks what is installed."""

from __future__ import annotations

import importlib.util
from pathlib import Path

from moseg_core.cli.console import print_line
from moseg_core.cli.scaffold import check_name, words, write_bundle
from moseg_core.components.discovery.distributions import installed_points, read_claims


def run_new(name: str, *, kind: str, out: Path | None) -> None:
    """Write the package and say what to do next."""
    check_name(name)
    chosen = words(name, kind)
    folder = Path(chosen["MY_DISTRIBUTION"]) if out is None else out
    written = write_bundle(folder, name, kind, taken=_taken(name, chosen["MY_PACKAGE"]))
    shown = [path.relative_to(folder).as_posix() for path in written]
    print_line(f"{folder}: the bundle '{name}' with the {kind} '{chosen['MY_COMPONENT']}'")
    for path in shown:
        print_line(f"  {path}")
    for line in ("", "Next:", f"  cd {folder}", '  pip install -e ".[test]"', "  pytest"):
        print_line(line)
    print_line(f"  moseg plugin check {name}")


def _taken(name: str, package: str) -> dict[str, str]:
    """Namespaces that are in use, with who has them; the asked one also for its package."""
    taken = {}
    if importlib.util.find_spec(package) is not None:
        taken[name] = f"an installed package '{package}'"
    for claim in read_claims(installed_points()):
        taken[claim.point.name] = f"{claim.distribution} {claim.version}, which is installed"
    return taken
