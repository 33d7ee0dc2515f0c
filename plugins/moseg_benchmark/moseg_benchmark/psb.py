"""The Princeton Segmentation Benchmark: models that people have cut into parts by hand.

Chen, Golovinskiy and Funkhouser 2009, doi:10.1145/1531326.1531379: 380 closed meshes in 19
categories of 20, each with some ten segmentations by people. Names for the parts are those of
Kalogerakis, Hertzmann and Singh 2010, doi:10.1145/1778765.1778839. The data is the user's own
copy; none comes with moseg. Expected in its folder are

::

    off/<id>.off                  the meshes
    seg/<id>/<id>_<k>.seg         the people's segmentations (or seg/Benchmark/<id>/...)
    labels/<id>_labels.txt        the named parts, where there are any

and any part of the models will do.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from moseg_benchmark.label_matching import Naming
from moseg_core import UsageError, unknown

# Ids come in blocks of 20. The 14th block of the collection that the meshes are from has no
# people's segmentations.
_BLOCKS = (
    *("Human", "Cup", "Glasses", "Airplane", "Ant", "Chair", "Octopus", "Table", "Teddy", "Hand"),
    *("Plier", "Fish", "Bird", "", "Armadillo", "Bust", "Mech", "Bearing", "Vase", "Fourleg"),
)
CATEGORIES = tuple(name for name in _BLOCKS if name)
"""Names of the categories, in the benchmark's order."""

NAMINGS = {
    "Fourleg": Naming(
        {
            "torso": ("body",),
            "tail": ("torso", "body"),
            "neck": ("head",),
            "earhorn": ("head",),
        }
    ),
    "Octopus": Naming({"body": ("head",), "leg": ("arm",)}),
    "Bird": Naming({"head": ("body",), "leg": ("body",)}),
    "Chair": Naming({"support": ("seat",), "backsupport": ("back",)}),
    "Table": Naming({"support": ("top",)}),
}
"""By category: what its parts count as under a recipe that has no label of their name."""


@dataclass(frozen=True)
class Model:
    """A mesh with what people say of it.

    Parameters
    ----------
    number : int
        The benchmark's id.
    category : str
    mesh : Path
    people : tuple of Path
        Segmentations by people.
    names : Path or None
        Named parts.
    """

    number: int
    category: str
    mesh: Path
    people: tuple[Path, ...]
    names: Path | None

    @property
    def teaches(self) -> bool:
        """Whether parts of two names or more are named, so that others can be learned from it."""
        if self.names is None:
            return False
        # A name that no face follows names no part.
        borne = re.findall(r"([^\d\s]\S*)\s+\d", self.names.read_text(errors="replace"))
        return len(set(borne)) > 1


def check_category(name: str) -> str:
    """A category by its name, upper or lower case.

    Raises
    ------
    UsageError
        Unknown category, with the nearest.

    Examples
    --------
    >>> check_category("fourleg")
    'Fourleg'
    """
    for category in CATEGORIES:
        if category.lower() == name.strip().lower():
            return category
    raise UsageError(unknown("category", name, CATEGORIES))


def category_of(number: int) -> str:
    """The category of a model; empty for an id that the benchmark does not have.

    Examples
    --------
    >>> category_of(381), category_of(270)
    ('Fourleg', '')
    """
    block = (number - 1) // 20
    return _BLOCKS[block] if 0 <= block < len(_BLOCKS) else ""


def find_models(data: Path, categories: tuple[str, ...] = ()) -> list[Model]:
    """The models in a folder, by id.

    Parameters
    ----------
    data : Path
    categories : tuple of str
        Only these; all by default.

    Raises
    ------
    UsageError
        The folder does not hold the benchmark, or no model of these categories.
    """
    for name in ("off", "seg"):
        if not (data / name).is_dir():
            raise UsageError(
                f"'{data}' does not hold the benchmark: there is no folder '{name}' in it, which"
                f" should have {'<id>.off' if name == 'off' else '<id>/<id>_<k>.seg'}"
            )
    people = data / "seg"
    if (people / "Benchmark").is_dir():
        people /= "Benchmark"
    models = []
    for mesh in (data / "off").glob("*.off"):
        if not mesh.stem.isdecimal() or not (category := category_of(int(mesh.stem))):
            continue
        if categories and category not in categories:
            continue
        pattern = re.compile(rf"{mesh.stem}_([0-9]+)\.seg")
        files = {
            int(match[1]): path
            for path in (people / mesh.stem).glob("*.seg")
            if (match := pattern.fullmatch(path.name))
        }
        names = data / "labels" / f"{mesh.stem}_labels.txt"
        models.append(
            Model(
                number=int(mesh.stem),
                category=category,
                mesh=mesh,
                people=tuple(files[k] for k in sorted(files)),
                names=names if names.is_file() else None,
            )
        )
    if not models:
        among = f" of {', '.join(categories)}" if categories else ""
        raise UsageError(f"there are no models{among} in '{data / 'off'}'")
    return sorted(models, key=lambda model: model.number)
