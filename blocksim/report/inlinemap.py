"""Pictures as a part of the page: colours follow the page's; points of the map are links."""

from __future__ import annotations

import colorsys
import re
from collections.abc import Mapping

PAGE = "report.html"
"""File beside map.svg to which its links lead."""
NOT_OURS = re.compile(r"<metadata>.*?</metadata>|<style.*?</style>|<!--.*?-->", re.DOTALL)
OPENING = re.compile(r"<svg\b[^>]*>")
BOX = re.compile(r'viewBox="[^"]*"')
STYLE = re.compile(r'style="[^"]*"')
COLOUR = re.compile(r"#([0-9a-f]{6})\b")
FILL = re.compile(r'(<rect [^>]*)fill="#([0-9a-f]{6})"')
"""Colour of hatching, the only one outside a style."""
OWN = re.compile(r'( id="|href="#|url\(#)')
"""Text before the name of an element of the picture."""
LINK = re.compile(rf'<a xlink:href="(?:{re.escape(PAGE)})?#row-(\d+)"(?: target="_blank")?')
DARKEST, LIGHTEST = 0.12, 0.93
"""Lightness of what is white and black by day, in the dark."""


def inline_map(svg: bytes, names: Mapping[int, str]) -> tuple[str, dict[str, str]]:
    """Turn a map into a part of the page, as `inline_picture` does. Its links name rows."""
    text, dark = inline_picture(svg, "map", "group", "map")
    reached: set[str] = set()

    def link(match: re.Match[str]) -> str:
        number = match[1]
        # By the keyboard a row is reached once, however many marks it has.
        again = ' tabindex="-1" aria-hidden="true"' if number in reached else ""
        reached.add(number)
        name = f"{number}, {names.get(int(number), '')}".replace("&", "&amp;")
        name = name.replace('"', "&quot;").replace("<", "&lt;")
        return f'<a href="#row-{number}" aria-label="{name}"{again}'

    return LINK.sub(link, text), dark


def inline_picture(svg: bytes, name: str, role: str, anchor: str) -> tuple[str, dict[str, str]]:
    """Turn a picture drawn for paper into a part of the page.

    `svg`: A file of SVG with its colours as #rrggbb in `style` attributes.
    `name`: Class of the element.
    `role`, `anchor`: What has the id `anchor-words` describes it. Ids within it begin with the
        anchor, where that is another than the name: no two on a page are the same.
    Returns `text`: An element, with each colour #rrggbb as the variable --name-rrggbb.
    Returns `dark`: Each colour rrggbb, and what it is in the dark.
    """
    text = svg.decode()
    text = NOT_OURS.sub("", text[text.index("<svg") :])
    opening = OPENING.match(text)
    box = BOX.search(opening[0]) if opening else None
    said = f'role="{role}" aria-labelledby="{anchor}-words"'
    head = f'<svg class="{name}" {box[0] if box else ""} {said}>'
    text = OPENING.sub(head, text, count=1)
    if anchor != name:
        text = OWN.sub(rf"\1{anchor}-", text)
    text = FILL.sub(r'\1style="fill: #\2"', text)
    found = {colour for style in STYLE.findall(text) for colour in COLOUR.findall(style)}
    text = STYLE.sub(lambda style: COLOUR.sub(rf"var(--{name}-\1)", style[0]), text)
    return text, {colour: _dark(colour) for colour in sorted(found)}


def _dark(colour: str) -> str:
    """Turn light into dark and dark into light, of the same hue."""
    red, green, blue = (int(colour[place : place + 2], 16) / 255 for place in (0, 2, 4))
    hue, light, saturation = colorsys.rgb_to_hls(red, green, blue)
    light = LIGHTEST - (LIGHTEST - DARKEST) * light
    shares = colorsys.hls_to_rgb(hue, light, saturation)
    return "".join(f"{round(share * 255):02x}" for share in shares)
