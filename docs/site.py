"""What mkdocs does besides: pages from the top of the repository, links, formulas.

Pages are written to be read in the repository, too. So their links are those of files there;
here they become links of the site. A link to a file that is no page becomes plain text.
"""

from __future__ import annotations

import html
import os
import re
from pathlib import Path
from typing import Any

from latex2mathml.converter import convert

ROOT = Path(__file__).resolve().parent.parent
DOCS = ROOT / "docs"
PAGES = {
    "README.md": "index.md",
    "CONTRIBUTING.md": "contributing.md",
    "ARCHITECTURE.md": "architecture.md",
    "CHANGELOG.md": "changelog.md",
    "NOTICE.md": "licences.md",
    "SECURITY.md": "security.md",
    "RELEASING.md": "releasing.md",
    "analysis/README.md": "studies.md",
}
"""Files outside docs/ that are pages of the site."""
TAG = re.compile(r"\\tag\{([^}]*)\}")
NAMED = re.compile(r"<mi>(sin|cos|cot|arctan|min)</mi>")
"""Functions, which want a little room around them."""
FIGURES = "analysis/figures"
SHOWN = {".png", ".csv", ".gz", ".mp4"}
NAMING = re.compile(r"<code>[^<]*--[^<]*</code>")
OPTION = re.compile(r"--[\w-]+")
LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^()\s]+)\)")
CODE = re.compile(r"(^```.*?^```|`[^`\n]+`)", flags=re.MULTILINE | re.DOTALL)
FORMULA = re.compile(
    r'<(span|div) class="arithmatex">\\([(\[])(.*?)\\[)\]]</\1>', flags=re.DOTALL
)


def on_files(files: Any, config: Any) -> Any:
    """Add the pages and figures that are kept elsewhere in the repository."""
    from mkdocs.structure.files import File

    found = {path: ROOT / name for name, path in PAGES.items()}
    shown = [path for path in (ROOT / FIGURES).iterdir() if path.suffix in SHOWN]
    found |= {f"figures/{path.name}": path for path in shown}
    for path, source in found.items():
        files.append(File.generated(config, path, abs_src_path=str(source)))
    return files


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Turn links of the repository into links of the site."""
    source = next((name for name, path in PAGES.items() if path == page.file.src_uri), None)
    written = ROOT / source if source else DOCS / page.file.src_uri
    return relinked(markdown, written, page.file.src_uri)


def on_page_content(content: str, **_: Any) -> str:
    """Turn formulas into MathML, which browsers draw by themselves; keep options in a line."""
    whole = NAMING.sub(
        lambda found: OPTION.sub(r'<span class="option">\g<0></span>', found[0]), content
    )
    return FORMULA.sub(_formula, whole)


def relinked(markdown: str, written: Path, page: str) -> str:
    """Return a page with links as they are on the site.

    Parameters
    ----------
    markdown : str
    written : Path
        File of the page.
    page : str
        Where it is on the site.
    """

    def link(found: re.Match[str]) -> str:
        mark, text, target = found.groups()
        if re.match(r"[a-z]+:|#", target):
            return found[0]
        path, _, anchor = target.partition("#")
        place = site_path((written.parent / path).resolve())
        if place is None:
            return text
        there = os.path.relpath(place, Path(page).parent)
        return f"{mark}[{text}]({there}{'#' + anchor if anchor else ''})"

    parts = CODE.split(markdown)
    # A link inside a link's text is a picture that is a link: the inner one comes first.
    return "".join(part if n % 2 else LINK.sub(link, part) for n, part in enumerate(parts))


def site_path(path: Path) -> str | None:
    """Return where a file of the repository is on the site; None where it is no part of it."""
    name = path.relative_to(ROOT).as_posix()
    if name in PAGES:
        return PAGES[name]
    if path.parent == ROOT / FIGURES and path.suffix in SHOWN:
        return f"figures/{path.name}"
    if path.is_relative_to(DOCS) and path.suffix != ".py":
        return path.relative_to(DOCS).as_posix()
    return None


def _formula(found: re.Match[str]) -> str:
    text, number = html.unescape(found[3]).strip(), ""
    if tag := TAG.search(text):
        text, number = text.replace(tag[0], ""), tag[1]
    block = found[2] == "["
    drawn = convert(text.strip(), display="block" if block else "inline")
    drawn = NAMED.sub(r'<mspace width="0.17em"/>\g<0><mspace width="0.17em"/>', drawn)
    if not block:
        return drawn
    told = f"<span>({number})</span>" if number else ""
    return f'<div class="formula">{drawn}{told}</div>'
