from __future__ import annotations

import numpy as np
import pytest

from moseg_core import (
    Example,
    LearnerSpec,
    PluginError,
    Recipe,
    ShapeError,
    Statement,
    UsageError,
    learn,
)
from moseg_core.components.discovery.registry import Bundle, Component, Registry
from moseg_core.problem.recipe import parse_recipe
from tests.made_up import STRIP


def example(names=("a", "b"), labels=None):
    halves = (np.arange(STRIP.n_elements) >= STRIP.n_elements // 2).astype(int)
    return Example(STRIP, halves if labels is None else labels, names)


def made_by(target):
    """A registry with a learner that does as a function of this module."""
    spec = LearnerSpec(name="profiles", target=f"tests.problem.test_learning:{target}")
    component = Component("made", "moseg-made 1.0", spec)
    return Registry([Bundle("made", "moseg-made", "1.0", "made_bundle", (component,))])


def counting(examples, *, weight: float = 1.0):
    names = sorted({name for example in examples for name in example.borne})
    stated = Statement(labels=tuple(names), minimize=f"{weight:g}*narrow({names[0]})")
    return Recipe(name="counted", statement=stated, learned_from=[f"{len(examples)} of them"])


def silent(examples):
    return None


def failing(examples):
    raise ValueError("no idea")


def refusing(examples):
    raise UsageError("label two parts or more")


def test_an_example_keeps_labels_of_its_own():
    labels = np.zeros(STRIP.n_elements, np.int32)
    kept = example(labels=labels)
    labels[:] = 1
    assert kept.labels.max() == 0
    assert not kept.labels.flags.writeable
    assert kept.borne == ("a",)


def test_elements_of_an_example_may_have_no_label():
    labels = np.full(STRIP.n_elements, -1)
    with pytest.raises(ShapeError, match=r"has a label$"):
        example(labels=labels)
    labels[-1] = 0
    assert example(labels=labels).borne == ("a",)
    labels[0] = -2
    with pytest.raises(ShapeError, match=r", and -1 where there is none$"):
        example(labels=labels)


def test_examples_that_do_not_fit_are_refused():
    with pytest.raises(ShapeError, match="one label for each"):
        example(labels=[0])
    with pytest.raises(ShapeError, match="allowed are 0 to 0"):
        example(names=("a",))
    with pytest.raises(UsageError, match="'a' is named twice"):
        example(names=("a", "a"))
    with pytest.raises(UsageError, match="is a text, not ''"):
        example(names=("a", ""))


def test_a_learner_gets_the_examples_and_its_parameters():
    found = learn([example(), example()], learner="profiles(weight=3)", source=made_by("counting"))
    assert found.minimize == "3*narrow(a)"
    assert found.learned_from == ("2 of them",)


def test_what_it_was_learned_from_is_part_of_the_text():
    found = learn([example()], source=made_by("counting"))
    assert 'learned_from = ["1 of them"]' in found.toml()
    assert parse_recipe(found.toml(), "counted") == found
    with pytest.raises(UsageError, match="'learned_from' must be a list of texts"):
        parse_recipe('learned_from = 3\nlabels = ["a"]\nminimize = "narrow(a)"', "odd")


@pytest.mark.parametrize(
    ("target", "kind", "message"),
    [
        ("silent", PluginError, "returned a NoneType, not a Recipe"),
        ("failing", PluginError, "learner 'made:profiles' of moseg-made 1.0 failed.*no idea"),
        ("refusing", UsageError, "label two parts or more"),
    ],
)
def test_what_goes_wrong_in_a_learner_bears_its_name(target, kind, message):
    with pytest.raises(kind, match=message):
        learn([example()], source=made_by(target))


def test_requests_are_checked_before_anything_is_learned():
    with pytest.raises(UsageError, match="nothing to learn from"):
        learn([], source=made_by("counting"))
    with pytest.raises(UsageError, match="an example is an Example"):
        learn([(STRIP, [0])], source=made_by("counting"))
    with pytest.raises(UsageError, match="did you mean 'profiles'"):
        learn([example()], learner="profils", source=made_by("counting"))
    with pytest.raises(UsageError, match="did you mean 'weight'"):
        learn([example()], learner="profiles(wieght=2)", source=made_by("counting"))
