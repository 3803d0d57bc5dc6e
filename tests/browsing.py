"""A page as a reader sees it: opened in a headless Chromium, wide and narrow, dark, and as printed."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from selenium.webdriver import Chrome, ChromeOptions
from selenium.webdriver.chrome.service import Service

WIDTHS = (1280, 390)  # px: a desk, a telephone
PAPER = 720  # px: A4 upright within its margins
METRICS = {"height": 900, "deviceScaleFactor": 1, "mobile": False}
FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--allow-file-access-from-files",
)  # fmt: skip
NOTHING = re.compile(r"(?<![\d.,])[-+]?0\.0{3,}(?![\dEe])")  # a finding that says it is 0 to the digits shown
FAULTS = """
const faults = [], shown = e => e.tagName + ' ' + (e.getAttribute('aria-label') || e.textContent).trim().slice(0, 60);
document.querySelectorAll('details').forEach(e => { e.open = true; });
const page = document.documentElement;
if (page.scrollWidth > page.clientWidth) {
  const out = [...document.querySelectorAll('body *')].filter(e => e.getBoundingClientRect().right > page.clientWidth + 1
    && !e.closest('.wide, .formula, math, svg, pre, .md-typeset__scrollwrap, .md-sidebar, .md-header, .md-search'));
  faults.push('page ' + page.scrollWidth + ' px wide in ' + page.clientWidth + ': ' + out.slice(0, 3).map(shown).join(' | '));
}
for (const e of document.querySelectorAll('.drawing svg, img')) {
  const box = e.getBoundingClientRect();
  if (!(box.width > 50 && box.height > 20) || (e.tagName === 'IMG' && !e.naturalWidth)) faults.push('figure not shown: ' + shown(e));
  if (box.right > page.clientWidth + 1) faults.push('figure clipped: ' + shown(e));
}
for (const e of document.querySelectorAll('.card, .card *, h1, h2, h3, p, li, figcaption, dd, summary')) {
  if (e.closest('math, svg, nav, .md-header, .md-sidebar, .md-search')) continue;
  if (e.scrollWidth > e.clientWidth + 1 && getComputedStyle(e).overflowX === 'hidden') faults.push('clipped: ' + shown(e));
}
for (const table of document.querySelectorAll('table')) {
  const columns = [...table.tHead.rows].at(-1).cells.length, rows = [...table.tBodies[0].rows];
  const count = table.parentElement.dataset.rows;
  if (count && +count !== rows.length) faults.push('rows missing: ' + shown(table));
  for (const row of rows) {
    const cells = [...row.cells].reduce((sum, cell) => sum + cell.colSpan, 0);
    if (cells !== columns) faults.push(cells + ' cells for ' + columns + ' columns: ' + shown(row));
    if (row.getBoundingClientRect().height < 5) faults.push('row not shown: ' + shown(row));
  }
  for (const cell of [rows.at(-1)?.cells[0], [...(rows.at(-1)?.cells ?? [])].at(-1)].filter(Boolean)) {
    cell.scrollIntoView({block: 'center', inline: 'center'});
    const box = cell.getBoundingClientRect(), seen = document.elementFromPoint(
      Math.min(Math.max((box.left + box.right) / 2, 1), innerWidth - 1), (box.top + box.bottom) / 2);
    if (!cell.contains(seen)) faults.push('not reachable: ' + shown(cell) + ' of ' + shown(table));
  }
}
for (const e of document.querySelectorAll('body [title]')) {
  if (!e.closest('.md-header, .md-sidebar, .headerlink, svg') && !e.matches('a, button, label'))
    faults.push('said on hover alone: ' + e.title);
}
return faults;
"""
COLOURS = "const s = getComputedStyle(document.body); return [s.backgroundColor, s.color];"
PRINTED = """
return [...document.querySelectorAll('.wide, .drawing')].filter(e => e.scrollHeight > e.clientHeight + 2
  || e.scrollWidth > e.clientWidth + 2).map(e => 'cut on paper: ' + e.getAttribute('aria-label'));
"""


@contextmanager
def chromium() -> Iterator[Chrome]:
    """A headless browser with a profile of its own."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        options = ChromeOptions()
        for flag in (*FLAGS, f"--user-data-dir={profile}"):
            options.add_argument(flag)
        options.binary_location = "/usr/bin/chromium"
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        browser = Chrome(options, Service("/usr/bin/chromedriver"))
        try:
            yield browser
        finally:
            browser.quit()


def faults(browser: Chrome, address: str) -> list[str]:
    """What is wrong with a page at both widths: overflow, clipping, figures, tables, the console, dark mode, print."""
    found: list[str] = []
    browser.get_log("browser")
    for width in WIDTHS:
        browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {**METRICS, "width": width})
        browser.get(address)
        found += [f"at {width} px: {fault}" for fault in browser.execute_script(FAULTS)]
    found += [f"console: {entry['message']}" for entry in browser.get_log("browser") if entry["level"] in ("SEVERE", "WARNING")]
    return found


def faults_of_report(browser: Chrome, text: str, folder: Path) -> list[str]:
    """The same for a report of plyflow, and what the one style promises: dark mode, paper, no finding that says 0.0000."""
    path = folder / "opened.html"
    path.write_text(text, encoding="utf-8")
    found = faults(browser, path.as_uri())
    dark = [{"name": "prefers-color-scheme", "value": "dark"}]
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": dark})
    back, ink = ([int(float(part)) for part in re.findall(r"[\d.]+", one)[:3]] for one in browser.execute_script(COLOURS))
    found += [] if max(back) < 60 and min(ink) > 180 else [f"dark mode: {ink} on {back}"]
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print", "features": []})
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {**METRICS, "width": PAPER})
    found += browser.execute_script(PRINTED)
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "", "features": []})
    said: Any = browser.execute_script("return document.body.innerText")
    return found + [f"says {what}" for what in sorted(set(NOTHING.findall(str(said))))]
