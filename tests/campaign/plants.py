#!/usr/bin/env python3
"""Draws the distributions that the campaign over plants has saved, as an SVG.

usage: plants.py SHARES SVG   SHARES as tests/campaign/plants.cpp writes it

Readable on a light and on a dark page; needs nothing but Python.
"""
import sys

WIDTH, HEIGHT = 860, 610
PANEL_WIDTH, PANEL_HEIGHT = 330, 190
LEFT, TOP = 62, 84
ACROSS, DOWN = 420, 266

# Row, title, unit below the axis, its range and ticks, what is allowed of each kind, and at which
# share of the plants.
PANELS = [
    ('overshoot', 'First step: overshoot', 'part of what is allowed',
     (0, 2.5), (0, 0.5, 1, 1.5, 2, 2.5), {'both': 1}, 99),
    ('settled', 'First step: time to settle', 'part of the time allowed',
     (0, 3), (0, 1, 2, 3), {'both': 1}, 95),
    ('tracking', 'Tracking after 10 s of driving', 'rms, by that of the loop that is told the plant',
     (0.8, 2), (0.8, 1, 1.2, 1.4, 1.6, 1.8, 2), {'both': 1.3}, 95),
    ('held', '5 m with heading hold', 'mm aside at the end',
     (0, 300), (0, 50, 100, 150, 200, 250, 300), {'carried': 60, 'lost': 150}, 95),
]
KINDS = ('carried', 'lost')

STYLE = '''
  text { font: 12px system-ui, "Segoe UI", Roboto, Helvetica, Arial, sans-serif; fill: #57606a; }
  .title { font-size: 14px; font-weight: 600; fill: #1f2328; }
  .page { fill: #ffffff; }
  .grid { stroke: #d8dee4; stroke-width: 1; }
  .axis { stroke: #8c959f; stroke-width: 1; }
  .curve { fill: none; stroke-width: 2.2; stroke-linejoin: round; }
  .bound { stroke-width: 1.4; stroke-dasharray: 5 4; }
  .dot { stroke: #ffffff; stroke-width: 1.5; }
  .carried { stroke: #0969da; } .dot.carried, text.carried { fill: #0969da; }
  .lost { stroke: #bc4c00; } .dot.lost, text.lost { fill: #bc4c00; }
  .both { stroke: #57606a; }
  text.carried, text.lost { stroke: none; font-weight: 600; }
  .dot.carried, .dot.lost { stroke: #ffffff; }
  @media (prefers-color-scheme: dark) {
    text { fill: #9198a1; }
    .title { fill: #f0f6fc; }
    .page { fill: #0d1117; }
    .grid { stroke: #262c36; }
    .axis { stroke: #656c76; }
    .carried { stroke: #58a6ff; } .dot.carried, text.carried { fill: #58a6ff; }
    .lost { stroke: #f0883e; } .dot.lost, text.lost { fill: #f0883e; }
    .both { stroke: #9198a1; }
    text.carried, text.lost { stroke: none; }
    .dot.carried, .dot.lost { stroke: #0d1117; }
  }
'''


def read(path):
    """{(row, kind): [figure at 0 %, ..., at 100 %]}, and ('plants', 'both'): [how many]"""
    found = {}
    with open(path, encoding='ascii') as file:
        for line in file:
            row, kind, *figures = line.split()
            found[row, kind] = [float(figure) for figure in figures]
    return found


def at(figures, percent):
    return figures[round(percent / 100 * (len(figures) - 1))]


def number(value):
    return f'{value:.1f}'.rstrip('0').rstrip('.')


def panel(out, index, shares):
    row, title, unit, (low, high), ticks, bounds, percent = PANELS[index]
    left = LEFT + index % 2 * ACROSS
    top = TOP + index // 2 * DOWN

    def x(value):
        return left + PANEL_WIDTH * (min(max(value, low), high) - low) / (high - low)

    def y(share):
        return top + PANEL_HEIGHT * (1 - share / 100)

    bottom = y(0)
    out.append(f'<text class="title" x="{left}" y="{top - 14}">{title}</text>')
    for share in (0, 25, 50, 75, 100):
        line = 'axis' if share == 0 else 'grid'
        out.append(f'<line class="{line}" x1="{left}" x2="{left + PANEL_WIDTH}" '
                   f'y1="{y(share):.1f}" y2="{y(share):.1f}"/>')
        out.append(f'<text x="{left - 8}" y="{y(share) + 4:.1f}" text-anchor="end">{share} %</text>')
    for tick in ticks:
        out.append(f'<line class="axis" x1="{x(tick):.1f}" x2="{x(tick):.1f}" '
                   f'y1="{bottom}" y2="{bottom + 4}"/>')
        out.append(f'<text x="{x(tick):.1f}" y="{bottom + 18}" text-anchor="middle">'
                   f'{number(tick)}</text>')
    out.append(f'<text x="{left + PANEL_WIDTH / 2}" y="{bottom + 36}" text-anchor="middle">'
               f'{unit}</text>')
    for kind, bound in bounds.items():
        out.append(f'<line class="bound {kind}" x1="{x(bound):.1f}" x2="{x(bound):.1f}" '
                   f'y1="{top}" y2="{bottom}"/>')
    for kind in KINDS:
        figures = shares[row, kind]
        step = 100 / (len(figures) - 1)
        seen = sum(figure <= high for figure in figures) + 1  # and where it leaves the panel
        points = [(x(figure), y(i * step)) for i, figure in enumerate(figures[:seen])]
        points.insert(0, (points[0][0], bottom))
        path = ' '.join(f'{px:.1f},{py:.1f}' for px, py in points)
        out.append(f'<polyline class="curve {kind}" points="{path}"/>')
    for place, kind in enumerate(KINDS):
        value = at(shares[row, kind], percent)
        if value <= high:
            out.append(f'<circle class="dot {kind}" cx="{x(value):.1f}" cy="{y(percent):.1f}" '
                       'r="4.5"/>')
        text = f'{value:.0f} mm' if row == 'held' else f'{value:.2f}'
        out.append(f'<text class="{kind}" x="{left + PANEL_WIDTH - 4}" '
                   f'y="{bottom - 30 + 18 * place:.1f}" text-anchor="end">'
                   f'{kind}: {text} at {percent} %</text>')


def draw(shares):
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" role="img" '
           'aria-label="Distributions over random plants">', f'<style>{STYLE}</style>',
           f'<rect class="page" width="{WIDTH}" height="{HEIGHT}" rx="6"/>',
           f'<text class="title" x="{LEFT}" y="32">Share of {shares["plants", "both"][0]:.0f} '
           'random plants at or below</text>']
    legend = LEFT + 292
    for kind, text in (('carried', 'remainder carried'), ('lost', 'remainder lost')):
        out.append(f'<line class="curve {kind}" x1="{legend}" x2="{legend + 26}" y1="28" y2="28"/>')
        out.append(f'<text x="{legend + 34}" y="32">{text}</text>')
        legend += 160
    out.append(f'<line class="bound both" x1="{legend}" x2="{legend + 26}" y1="28" y2="28"/>')
    out.append(f'<text x="{legend + 34}" y="32">allowed</text>')
    for index in range(len(PANELS)):
        panel(out, index, shares)
    out.append('</svg>')
    return '\n'.join(out) + '\n'


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    with open(sys.argv[2], 'w', encoding='utf-8') as file:
        file.write(draw(read(sys.argv[1])))


if __name__ == '__main__':
    main()
