"""A new bundle from nothing: a package that is installed, tested and found as it is.

What is written are plain files in ``templates``: those in ``templates/package`` for every bundle,
those in the folder of a kind besides. In their names and texts a few words stand for what the
author chooses, ``MY_NAME`` among them (:func:`words`); that is all there is to it. Their suffix
``.txt`` keeps them from being taken for modules of the core, and is left out of what is written;
``dot_`` stands for a leading dot, which some packagers leave behind.

Each kind comes with one real component (:data:`SKETCHES`), small enough to be read in a minute and
to be changed into another one, with tests of its own beside the contract's.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path

from moseg_core.components.discovery.contract import CONTRACT, VERSION
from moseg_core.components.discovery.specs import NAME
from moseg_core.errors import UsageError, nearest, unknown


@dataclass(frozen=True, kw_only=True)
class Sketch:
    """The component that a new bundle starts with.

    Parameters
    ----------
    component : str
        Its name.
    summary : str
        One line, as in ``moseg plugin list``.
    use : tuple of str
        Command lines that use it.
    needs : tuple of str
        Distributions beside the core whose components it names.
    """

    component: str
    summary: str
    use: tuple[str, ...]
    needs: tuple[str, ...] = ()


_SAMPLE = "moseg sample hammer -o hammer.ply"
_HAMMER = "moseg segment hammer.ply --labels handle,head"
_WHOLE = (_HAMMER, "    --minimize 'narrow(handle) + convex_parts'")

SKETCHES: Mapping[str, Sketch] = {
    "objective": Sketch(
        component="slender",
        summary="one part: some times as long as it is wide, or longer",
        use=(_SAMPLE, _HAMMER, "    --minimize 'slender(handle, ratio=6) + convex_parts'"),
    ),
    "field": Sketch(
        component="crowded",
        summary="how much of the shape is near an element: much in the middle, little at tips",
        use=(_SAMPLE, "moseg field hammer.ply 'crowded(reach=0.1)' -o crowded.png"),
    ),
    "seeder": Sketch(
        component="scattered",
        summary="random elements, far from each other (greedy k-means++)",
        use=(_SAMPLE, *_WHOLE, "    --seeder 'scattered(tries=5)'"),
    ),
    "labeler": Sketch(
        component="exchange",
        summary="optimal for single parts, then exchanges of two labels by the whole cost",
        use=(_SAMPLE, *_WHOLE, "    --labeler exchange"),
    ),
    "optimizer": Sketch(
        component="gaussian_steps",
        summary="random steps around the best, longer after success (evolution strategy)",
        use=(_SAMPLE, *_WHOLE, "    --optimizer 'gaussian_steps(children=10)'"),
    ),
    "parameterization": Sketch(
        component="minkowski",
        summary="weighted Voronoi partition in which circles may be diamonds or boxes",
        use=(
            _SAMPLE,
            "moseg recipes paper_hammer > mine.toml",
            "echo 'parameterization = \"minkowski(power=8)\"' >> mine.toml",
            "moseg segment hammer.ply --recipe mine.toml",
        ),
    ),
    "refiner": Sketch(
        component="majority",
        summary="an element takes the label that most of its neighbours bear; takes teeth off",
        use=(_SAMPLE, *_WHOLE, "    --refiner 'majority(rounds=5)'"),
    ),
    "constraint": Sketch(
        component="same_weight",
        summary="same_weight(leg*): centres of one weight, wherever they are",
        use=(
            "moseg sample horse -o horse.ply",
            "moseg segment horse.ply --recipe paper_horse --constraint 'same_weight(leg*)'",
        ),
    ),
    "embedding": Sketch(
        component="rounded",
        summary="stretched across until as wide and high as long",
        use=(_SAMPLE, *_WHOLE, "    --embedding rounded"),
    ),
    "measure": Sketch(
        component="reach",
        summary="greatest distance of a part's surface from its centroid",
        use=("moseg plugin explain reach",),
    ),
    "learner": Sketch(
        component="shares",
        summary="parts as large as those of the examples, give or take",
        use=(
            "moseg sample hammer -o hammer.ply --labels hammer.txt",
            "moseg learn hammer.ply=hammer.txt --learner shares -o mine.toml",
        ),
        needs=("moseg-objectives-basic",),
    ),
    "recipe": Sketch(
        component="bottle",
        summary="a body with a narrow neck",
        use=("moseg segment wine.ply --recipe bottle -o wine.glb",),
        needs=("moseg-objectives-basic",),
    ),
    "reader": Sketch(
        component="raw_triangles",
        summary="text files with the nine numbers of a triangle in a line",
        use=("moseg segment scan.raw --recipe hammer -o scan.glb",),
    ),
    "writer": Sketch(
        component="parts_list",
        summary="a line for each part: name, elements, share of the area",
        use=(_SAMPLE, "moseg segment hammer.ply --recipe hammer -o hammer.list"),
    ),
    "command": Sketch(
        component="areas",
        summary="How large the parts of a labelling are.",
        use=(
            "moseg sample hammer -o hammer.ply --labels hammer.txt",
            "moseg areas hammer.ply hammer.txt",
        ),
    ),
}
"""The kinds that can be sketched, in the order in which they are offered."""


def words(name: str, kind: str) -> dict[str, str]:
    """What the words in the templates stand for.

    Examples
    --------
    >>> chosen = words("steel_parts", "objective")
    >>> chosen["MY_DISTRIBUTION"], chosen["MY_PACKAGE"], chosen["MY_COMPONENT"]
    ('moseg-steel-parts', 'moseg_steel_parts', 'slender')
    """
    sketch = SKETCHES[kind]
    return {
        "MY_DISTRIBUTION": f"moseg-{name.replace('_', '-')}",
        "MY_PACKAGE": f"moseg_{name}",
        "MY_NAME": name,
        "MY_COMPONENT": sketch.component,
        "MY_SUMMARY": sketch.summary,
        "MY_SENTENCE": sketch.summary.rstrip(".") + ".",
        "MY_KIND": kind,
        "MY_NEEDS": "".join(f', "{needed}>={VERSION}"' for needed in sketch.needs),
        "MY_USE": re.sub(r"\n +--", r" \\\g<0>", "\n".join(f"    {line}" for line in sketch.use)),
        "CORE_VERSION": VERSION,
        "CORE_CONTRACT": str(CONTRACT),
    }


def render(name: str, kind: str) -> dict[str, str]:
    """The files of a new bundle: for each path, with ``/``, its text.

    Parameters
    ----------
    name : str
        Namespace of the bundle.
    kind : str
        A key of :data:`SKETCHES`.

    Raises
    ------
    UsageError
        A name that is no namespace, with what is allowed; an unknown kind, with the nearest.

    Examples
    --------
    >>> sorted(render("vessels", "objective"))[-2:]
    ['tests/test_contract.py', 'tests/test_slender.py']
    """
    check_name(name)
    if kind not in SKETCHES:
        message = unknown("kind", kind, SKETCHES)
        known = "" if nearest(kind, SKETCHES) is None else f" Known: {', '.join(SKETCHES)}"
        raise UsageError(message + known)
    chosen = words(name, kind)
    templates = resources.files(__name__) / "templates"
    found: dict[str, str] = {}
    for folder in ("package", kind):
        found |= {
            _replaced(path, chosen): _replaced(text, chosen)
            for path, text in _files(templates / folder)
        }
    return dict(sorted(found.items()))


def check_name(name: str) -> None:
    """Refuse what cannot be a namespace.

    Raises
    ------
    UsageError
        With what is allowed, and a name of that kind near to the one given where there is one.
    """
    if NAME.match(name):
        return
    plain = "".join(c if c.isascii() and c.isalnum() else "_" for c in name.lower())
    plain = plain.removeprefix("moseg_").strip("_")
    guess = f"; did you mean '{plain}'?" if NAME.match(plain) else ", as in 'steel_parts'"
    raise UsageError(
        f"'{name}' cannot be the name of a bundle: lower-case letters, digits and _, a letter"
        f" first{guess}"
    )


def write_bundle(
    folder: Path, name: str, kind: str, *, taken: Mapping[str, str] | None = None
) -> list[Path]:
    """Write a new bundle.

    Parameters
    ----------
    folder : Path
        Made; must not exist, or be empty.
    name, kind : str
        See :func:`render`.
    taken : mapping of str to str, optional
        Namespaces that cannot be chosen, with who has them.

    Returns
    -------
    list of Path
        What was written.

    Raises
    ------
    UsageError
        See :func:`render`; the name is taken; the folder has something in it, or cannot be
        written.
    """
    files = render(name, kind)
    if taken and name in taken:
        raise UsageError(
            f"the name '{name}' is taken by {taken[name]}, and two bundles of one name are both"
            f" set aside; choose another"
        )
    if folder.exists() and not (folder.is_dir() and not any(folder.iterdir())):
        raise UsageError(
            f"'{folder}' is there already; choose another name, or another folder with --out"
        )
    written = []
    try:
        for path, text in files.items():
            target = folder / path
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(text, encoding="utf-8")
            written.append(target)
    except OSError as error:
        raise UsageError(f"cannot write '{folder}': {error.strerror or error}") from error
    return written


def _files(folder: Traversable, prefix: str = "") -> list[tuple[str, str]]:
    """Paths below a folder and their texts, without ``.txt`` and with leading dots."""
    found = []
    for entry in folder.iterdir():
        plain = entry.name.removesuffix(".txt")
        name = f".{plain.removeprefix('dot_')}" if plain.startswith("dot_") else plain
        if entry.is_dir():
            found += _files(entry, f"{prefix}{name}/")
        else:
            found.append((f"{prefix}{name}", entry.read_text(encoding="utf-8")))
    return found


def _replaced(text: str, chosen: Mapping[str, str]) -> str:
    for word, meaning in chosen.items():
        text = text.replace(word, meaning)
    return text
