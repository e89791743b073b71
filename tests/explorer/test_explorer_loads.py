"""Loads and fill that are laid on the arch beside the map, held to Python."""

import math
import re
from typing import Any
from urllib.parse import parse_qs

import numpy as np
import pytest
from windows import settle, wait_until

from blocksim import Problem, collapse, equilibrium, structure_of

playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

TOLERANCE = 1e-6
NARROW = 1e-9
"""Half the width of a load at a point."""
ANALYSE = """(all) => all.map(({ alpha, mu, voussoirs, ...rest }) => {
  const state = { halfAngle: alpha * Math.PI / 180, mu: mu === "inf" ? Infinity : mu, ...rest };
  const { rest: forces, bears, falls, place } = loaded.analyse(state, voussoirs);
  return { margin: forces.margin, factor: String(bears.factor), motions: falls.motions, place };
})"""


def random_arch(random: np.random.Generator) -> dict[str, Any]:
    alpha = random.uniform(15, 90) if random.random() < 0.6 else random.uniform(90, 150)
    return {
        "alpha": alpha,
        "eta": float(np.exp(random.uniform(np.log(0.01), np.log(0.6)))),
        "mu": "inf" if random.random() < 0.15 else random.uniform(0.2, 1.3),
        "voussoirs": int(random.integers(3, 41)),
        "weight": "sector" if random.random() < 0.5 else "centreline",
        "fill": random.uniform(0.01, 0.6) if alpha < 90 and random.random() < 0.5 else 0,
        "load": {"place": random.uniform(-0.98, 0.98), "share": random.uniform(0, 0.4)},
    }


def problem_of(given: dict[str, Any], place: float) -> Problem:
    """The same arch, with a load at a place over the radius."""
    arch = {
        "kind": "circular-arch",
        "weight": "curved" if given["weight"] == "sector" else "centreline",
        "half_angle_deg": given["alpha"],
        **{each: given[each] for each in ("eta", "voussoirs", "fill") if given[each]},
        "friction": float(given["mu"]),
    }
    heavy = float(weights_of(structure_of(arch)).sum())
    load = {"patch": [place - NARROW, place + NARROW], "force": [0.0, -heavy]}
    return structure_of({**arch, "live": [load]}).with_load(given["load"]["share"])


def weights_of(problem: Problem) -> np.ndarray:
    return np.array([block.mass for block in problem.assembly.blocks]) * 9.81


def work_of(problem: Problem, motions: np.ndarray) -> tuple[float, float]:
    """Work of weights and live loads in a mechanism: no joint closes, what slides dilates."""
    assembly = problem.assembly

    def speed(block: int, point: np.ndarray) -> np.ndarray:
        if not 0 <= block < len(motions):
            return np.zeros(2)
        x, y, turn = motions[block]
        return np.array([x - turn * point[1], y + turn * point[0]])

    for joint in assembly.joints:
        along = (joint.outer - joint.inner) / np.linalg.norm(joint.outer - joint.inner)
        across = np.array([along[1], -along[0]])
        ends = [
            speed(joint.after, p) - speed(joint.before, p) for p in (joint.inner, joint.outer)
        ]
        opening = min(float(across @ each) for each in ends)
        slip = abs(float(along @ ends[0])) if math.isfinite(problem.mu) else 0.0
        assert opening > (problem.mu * slip if slip else 0) - TOLERANCE
    weights = -weights_of(problem)
    own = sum(
        w * speed(i, b.centre)[1]
        for i, (w, b) in enumerate(zip(weights, assembly.blocks, strict=True))
    )
    own += sum(load.force @ speed(*load.blocks, load.point) for load in problem.dead)
    live = sum(load.force @ speed(*load.blocks, load.point) for load in problem.live)
    return own, live


@pytest.mark.parametrize("count", [60, pytest.param(500, marks=pytest.mark.long)])
def test_random_loaded_arches_are_judged_as_by_python(one_page: Any, count: int) -> None:
    random = np.random.default_rng(41)
    given = [random_arch(random) for _ in range(count)]
    verdicts, factors = set[bool](), set[str]()
    for each, found in zip(given, one_page.evaluate(ANALYSE, given), strict=True):
        problem = problem_of(each, found["place"])
        stands = equilibrium(problem).exists
        assert (found["margin"] > 0) == stands, each
        verdicts.add(stands)
        exact = collapse(problem).load_factor
        if exact is None or exact < 0:
            assert found["factor"] == "null", each
            own, live = work_of(problem, np.array(found["motions"]))
            assert own + each["load"]["share"] * live > 0
            factors.add("none")
            continue
        factor = float(found["factor"].replace("Infinity", "inf"))
        assert factor == pytest.approx(exact, rel=TOLERANCE, abs=TOLERANCE), each
        factors.add("any" if math.isinf(factor) else "some")
        if math.isfinite(factor):
            own, live = work_of(problem, np.array(found["motions"]))
            assert live > 0
            nothing = TOLERANCE * weights_of(problem).sum()
            assert own + factor * live == pytest.approx(0, abs=nothing)
    assert verdicts == {True, False}
    assert factors == {"none", "any", "some"}


def told(page: Any) -> str:
    settle(page)
    return page.inner_text("#verdict") + ". " + page.inner_text("#because")


def bears(page: Any) -> float:
    found = re.search(r"bears ([\d.]+) % of its own weight", told(page))
    assert found
    return float(found[1]) / 100


def middle(page: Any, what: str) -> tuple[float, float]:
    settle(page)
    box = page.locator(f"#arch .{what} .grip").bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def drag(page: Any, what: str, across: float, down: float) -> None:
    x, y = middle(page, what)
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + across, y + down, steps=4)
    page.mouse.up()
    settle(page)


def asked(page: Any) -> Problem:
    """The arch of the controls, with what lies on it, as Python makes it."""
    # The code of a frame has the address as it is drawn; the page's own comes later.
    address = parse_qs(page.input_value("#code").split("#")[1].split('"')[0])
    alpha, mu, eta, fill = (
        float(address.get(each, ["0"])[0]) for each in ("alpha", "mu", "eta", "fill")
    )
    share, place = map(float, address["load"][0].split("_"))
    assert share == pytest.approx(float(page.input_value("#press-number")), abs=1e-3)
    given = {
        "alpha": alpha, "mu": mu, "eta": eta, "voussoirs": int(address["n"][0]),
        "weight": "centreline", "fill": fill, "load": {"share": share},
    }  # fmt: skip
    wide = (1 + eta / 2) * math.sin(math.radians(min(90, alpha)))
    return problem_of(given, place * wide)


def to_arch(page: Any) -> None:
    for name, value in (("alpha", 80), ("mu", 0.7), ("eta", 0.2)):
        page.fill(f"#{name}-number", str(value))
    page.locator("#stones").fill("21")
    settle(page)


def test_a_load_and_fill_are_dragged_onto_the_arch_and_the_address_holds_them(
    page: Any,
) -> None:
    to_arch(page)
    assert page.locator("#bare-map").is_hidden()
    point = page.locator("#map .handle .ring").bounding_box()
    drag(page, "load", 240, 10)
    assert told(page).startswith("Stands: 21 voussoirs under load")
    assert bears(page) == pytest.approx(collapse(asked(page)).load_factor, rel=1e-3)
    before = bears(page)
    drag(page, "load", 60, -20)  # along the arch, and larger
    assert bears(page) < before
    assert bears(page) == pytest.approx(collapse(asked(page)).load_factor, rel=1e-3)
    before = bears(page)
    drag(page, "fill-road", 250, -60)
    assert "under load and fill" in told(page)
    assert bears(page) > before
    assert bears(page) == pytest.approx(collapse(asked(page)).load_factor, rel=1e-3)
    # The map is without them, and says so; its point stays.
    assert "without load and fill" in page.inner_text("#bare-map")
    assert page.locator("#map .handle .ring").bounding_box()["x"] == point["x"]
    wait_until(page, lambda: "fill=" in page.url)
    address, said = page.url, told(page)
    page.goto("about:blank")
    page.goto(address)
    assert told(page) == said
    drag(page, "fill-road", 0, 200)  # below the crown: none
    assert "fill" not in page.inner_text("#verdict")
    drag(page, "load", -600, 0)  # beside the arch: none
    assert page.locator("#bare-map").is_hidden()
    assert "21 voussoirs as built" in page.inner_text("#verdict")


def test_a_load_by_keyboard_brings_the_arch_down_as_python_says(page: Any) -> None:
    """Sliders and numbers; the scrubber goes from no load to the most, and lets it fall."""
    to_arch(page)
    page.click("#acts summary")
    page.locator("#place").focus()
    for _ in range(30):
        page.keyboard.press("ArrowRight")
    page.fill("#press-number", "0.2")
    assert float(page.input_value("#place-number")) == pytest.approx(0.3)
    most = bears(page)
    assert most == pytest.approx(collapse(asked(page)).load_factor, rel=1e-3)
    page.fill("#press-number", f"{1.01 * most:.6f}")
    assert told(page).startswith("Collapses: 21 voussoirs under load")
    assert not equilibrium(asked(page)).exists
    assert page.locator("#arch .hinge").count() == 4
    page.locator("#scrub").fill("0.25")
    settle(page)
    assert float(page.input_value("#press-number")) == pytest.approx(most / 2, rel=1e-3)
    assert told(page).startswith("Stands")
    page.locator("#scrub").fill("0.5")
    assert told(page).startswith("On the verge")
    page.fill("#fill-number", "0.3")
    assert bears(page) > 1.2 * most
    assert bears(page) == pytest.approx(collapse(asked(page)).load_factor, rel=1e-3)
    page.fill("#alpha-number", "120")  # its extrados turns back
    settle(page)
    assert page.locator("#fill").is_disabled()
    assert "fill" not in page.inner_text("#verdict")
    page.check("#continuous")  # loads lie on voussoirs
    assert "the continuous arch" in told(page)
    assert page.locator("#bare-map").is_hidden()


def test_a_finger_lays_a_load_on_the_arch(open_page: Any) -> None:
    page = open_page(390, 844, has_touch=True, is_mobile=True)
    to_arch(page)
    page.locator("#arch").scroll_into_view_if_needed()
    before = page.evaluate("scrollY")
    fingers = page.context.new_cdp_session(page)
    x, y = middle(page, "load")
    for kind, share in (("touchStart", 0), ("touchMove", 0.4), ("touchMove", 1)):
        touch = [{"x": x + 190 * share, "y": y + 5 * share}]
        fingers.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": touch})
        settle(page)
    fingers.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
    wait_until(page, lambda: "under load" in page.inner_text("#verdict"))
    assert page.evaluate("scrollY") == before
    assert bears(page) == pytest.approx(collapse(asked(page)).load_factor, rel=1e-3)
