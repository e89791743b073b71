"""The explorer's second view: any blocks, judged in the page and dragged."""

import math
from typing import Any

import numpy as np
import pytest
from arches import least
from shapely import Polygon
from windows import settle

from blocksim import (
    Arcade,
    CircularArch,
    Column,
    Portal,
    Rubble,
    Stack,
    Wall,
    collapse,
    equilibrium,
    load_structure,
    structure_of,
)

playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

TOLERANCE = 1e-6
LOOKS = {
    "Stands": "stands",
    "Nothing can move": "stands",
    "Collapses": "collapses",
    "On the verge": "undecided",
    "Undecided": "undecided",
    "Blocks overlap": "wrong",
}
"""The colour of each verdict: what is open looks neither as what stands nor as what falls."""
ANALYSE = """(all) => all.map((each) => {
  const mu = each.mu === "inf" ? Infinity : each.mu;
  const { joints, rest, bears, tilts } = blockwork.analyse({ ...each, mu });
  const plain = (value) => (value === null ? null : String(value));
  return [joints.length, rest.margin, bears.factor, tilts[0].factor].map(plain);
})"""


def random_blocks(random: np.random.Generator, at: int) -> dict[str, Any]:
    """Blocks of one of six kinds, rubbed, loaded at a random point and tilted."""
    between, whole = random.uniform, lambda low, high: int(random.integers(low, high))
    arch = CircularArch(
        half_angle_deg=90, eta=between(0.1, 0.3), voussoirs=whole(5, 12), friction=0.5
    )
    maker = [
        lambda: Wall(length=between(2, 4), courses=whole(2, 6), block_length=0.8, friction=1),
        lambda: Stack(rows=whole(3, 7), overhang=between(0.01, 1.5), friction=1),
        lambda: Arcade(arch=arch, pier_height=between(0.3, 2), friction=1),
        lambda: Portal(arch=arch, pier_height=between(0.3, 2), friction=1),
        lambda: Column(drums=whole(1, 7), drum_height=0.6, width=between(0.4, 1), friction=1),
        lambda: Rubble(width=2.5, stones=whole(6, 20), seed=whole(1, 999), friction=1),
    ][at % 6]()
    assembly = maker.problem().assembly
    moving = [block.vertices.tolist() for block in assembly.blocks]
    fixed = [each.tolist() for support in assembly.supports for each in support.polygons]
    block = whole(0, len(moving))
    share = random.dirichlet(np.ones(len(moving[block])))
    return {
        "blocks": [{"corners": c, "fixed": False} for c in moving]
        + [{"corners": c, "fixed": True} for c in fixed],
        "mu": "inf" if random.random() < 0.1 else between(0.2, 1.2),
        "load": {
            "block": block,
            "point": (share @ np.array(moving[block])).tolist(),
            "share": between(0, 0.3),
        },
        "tilt": between(-0.2, 0.2),
    }


def as_structure(each: dict[str, Any], aside: float | None = None) -> dict[str, Any]:
    """A structure file of the same: pulled by its load, or aside by what weighs down."""
    down = [math.sin(each["tilt"]), -math.cos(each["tilt"])]
    if aside is not None:
        down = [0.0, -1.0]
    weight = sum(
        Polygon(block["corners"]).area for block in each["blocks"] if not block["fixed"]
    )
    load = each["load"]
    on = {"block": load["block"], "point": load["point"]}
    table = {
        "friction": each["mu"],
        "density": 1.0,
        "blocks": [
            {"id": at, "vertices": block["corners"], "fixed": block["fixed"]}
            for at, block in enumerate(each["blocks"])
        ],
        "dead": [{"body": down}],
        "live": [{**on, "force": [weight * way for way in down]}],
        "load": load["share"],
    }
    if aside is not None:
        of_load = weight * load["share"]
        table["dead"].append({**on, "force": [0.0, -of_load]})
        table["live"] = [{"body": [aside, 0.0]}, {**on, "force": [aside * of_load, 0.0]}]
    return table


@pytest.mark.parametrize("count", [12, pytest.param(504, marks=pytest.mark.long)])
def test_random_blocks_are_judged_as_by_python(one_page: Any, count: int) -> None:
    random = np.random.default_rng(40)
    given = [random_blocks(random, at) for at in range(count)]
    verdicts = set()
    for each, (joints, margin, *factors) in zip(
        given, one_page.evaluate(ANALYSE, given), strict=True
    ):
        problem = structure_of(as_structure(each))
        assert int(joints) == len(problem.assembly.joints)
        stands = equilibrium(problem).exists
        assert (margin is not None and float(margin) > 0) == stands, each
        verdicts.add(stands)
        for factor, asked in zip(
            factors, (problem, structure_of(as_structure(each, aside=1.0))), strict=True
        ):
            exact = collapse(asked).load_factor
            if exact is None or exact < 0:
                assert factor is None, each
            else:
                assert float(factor.replace("Infinity", "inf")) == pytest.approx(
                    exact, rel=TOLERANCE, abs=TOLERANCE
                )
    assert verdicts == {True, False}


def to_own(page: Any) -> None:
    """Go to the view of any blocks, which the page shows when it hears of its new address."""
    page.click("#to-own")
    page.wait_for_selector("#own [data-block]")


def told(page: Any) -> str:
    settle(page)
    verdict = page.inner_text("#own-verdict")
    assert page.get_attribute("#own-verdict", "class") == f"verdict {LOOKS[verdict]}"
    return verdict + ". " + page.inner_text("#own-because")


def drag(page: Any, what: str, across: float, down: float) -> None:
    settle(page)
    box = page.locator(what).bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + across / 2, y + down / 2)
    page.mouse.move(x + across, y + down)
    page.mouse.up()
    settle(page)


def test_shipped_structures_stand_in_the_page_as_they_do_in_python(page: Any) -> None:
    to_own(page)
    for name in ("box2d_arch", "ferris_tinloi_3", "gable", "harmonic_5"):
        page.select_option("#structure", name)
        stands = equilibrium(load_structure(name)).exists
        assert told(page).startswith("Stands" if stands else "Collapses")
        assert structure_of(page.evaluate("own.structure()")).mu == load_structure(name).mu


def test_blocks_load_and_corners_are_dragged_and_the_address_holds_them(page: Any) -> None:
    to_own(page)
    assert told(page).startswith("Stands")
    before = told(page)
    drag(page, "#own [data-load] .grip", 60, 20)
    assert told(page) != before  # the haunch bears another load than the crown
    page.fill("#load-number", "0.3")
    assert told(page).startswith("Collapses")
    problem = structure_of(page.evaluate("own.structure()"))
    exact = collapse(problem).load_factor
    assert f"bears {100 * exact:.4g} %" in told(page)
    page.fill("#load-number", "0")
    drag(page, "#own [data-block='0']", -80, -30)  # the foot of a pier, out from under it
    assert told(page).startswith(("Collapses", "Blocks overlap"))
    assert page.input_value("#structure") == "own"
    address, said = page.evaluate("location.href"), told(page)
    page.goto("about:blank")
    page.goto(address)
    assert told(page) == said
    assert page.evaluate("performance.getEntriesByType('resource').length") == 0


def test_a_wall_of_ones_own(page: Any) -> None:
    """A block more, on the keyboard; what is fixed cannot fall; the map is still there."""
    to_own(page)
    page.select_option("#structure", "column")
    settle(page)
    before = page.locator("#own [data-block]").count()
    page.click("#add")
    assert told(page).startswith("Collapses")  # nothing holds it
    page.check("#fixed")
    assert told(page).startswith("Stands")
    page.focus("#own")
    page.keyboard.press("Delete")
    settle(page)
    assert page.locator("#own [data-block]").count() == before
    assert told(page).startswith("Stands")
    page.fill("#lean-number", "40")
    assert told(page).startswith("Collapses")
    page.select_option("#structure", "column")
    page.fill("#rub-number", "2")
    page.fill("#lean-number", repr(math.degrees(math.atan(1 / 3))))  # a third as wide as high
    assert told(page).startswith("On the verge")
    page.click("#to-map")
    page.wait_for_selector("#map")
    settle(page)
    assert page.inner_text("#verdict").startswith("On the verge")


def test_an_arch_from_three_voussoirs_to_the_continuous_one_and_with_a_load(page: Any) -> None:
    for voussoirs in (3, 11, 60):
        page.locator("#stones").fill(str(voussoirs))
        settle(page)
        for name, value in (("alpha", 90), ("mu", 0.7), ("eta", 0.2)):
            page.fill(f"#{name}-number", str(value))
        settle(page)
        known = least(math.pi / 2, 0.7, voussoirs)
        shown = page.inner_text("#built-eta").replace("any", "0")
        assert float(shown) == pytest.approx(known.eta_limit, rel=1e-5, abs=1e-12)
        assert f"{voussoirs} voussoirs as built" in page.inner_text("#verdict")
    page.locator("#stones").fill("61")
    settle(page)
    assert "the continuous arch" in page.inner_text("#verdict")
    page.locator("#stones").fill("11")
    page.click("#carry")
    page.wait_for_selector("#own [data-block]")
    drag(page, "#own [data-load] .grip", 60, 40)
    problem = structure_of(page.evaluate("own.structure()"))
    assert len(problem.assembly.blocks) == 11
    exact = collapse(problem).load_factor
    assert f"bears {100 * exact:.4g} %" in told(page)
    page.click("#to-map")
    page.wait_for_selector("#map")
    settle(page)
    assert page.input_value("#voussoirs") == "11"
