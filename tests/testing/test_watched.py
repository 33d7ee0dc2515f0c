from __future__ import annotations

import pytest

from moseg_core.segmentation import Segmentation
from moseg_core.testing.watched import watched
from moseg_core.testing.zoo import specimen


def seen(name="cube"):
    shape = specimen(name)
    labels = [k % 2 for k in range(shape.n_elements)]
    return watched(Segmentation.from_labels(shape, labels, 2))


@pytest.mark.parametrize(
    ("read", "noted"),
    [
        (lambda part: part.shape.volume, {"volume"}),
        (lambda part: part.shape.adjacency, {"adjacency"}),
        (lambda part: part.n_components, {"adjacency"}),
        (lambda part: part.triangles, {"triangles"}),
        (lambda part: part.to_mesh(), {"to_mesh", "triangles", "vertices"}),
        (lambda part: part.scales, set()),
        (lambda part: part.shape.areas, set()),
    ],
)
def test_what_is_read_is_noted(read, noted):
    whole, reads = seen()
    read(whole.parts[1])
    assert reads == noted


def test_the_whole_is_watched_too():
    whole, reads = seen()
    assert whole.shape.volume == 1.0
    assert reads == {"volume"}


def test_what_the_core_reads_to_remember_values_does_not_count():
    whole, reads = seen("lump")
    part = whole.parts[0]
    assert part.measure("basic:hull_volume") > 0
    assert reads == {"vertices"}


def test_it_measures_the_same():
    shape = specimen("lump")
    plain = Segmentation.from_labels(shape, [0] * shape.n_elements, 1)
    whole, _ = watched(plain)
    assert whole.parts[0].scales.tolist() == plain.parts[0].scales.tolist()
    assert whole.parts[0].membership == plain.parts[0].membership
    assert whole.shape.key == shape.key
