#!/usr/bin/env python3
"""The tables of bench/results/chart.md, from what `seldinger chart` wrote.

    bench/chart_page.py DIR [--page bench/results/chart.md]

Reads chart.csv and references.csv of DIR and writes two tables over what stands between the marks <!-- published --> … <!-- end --> and
<!-- fronts --> … <!-- end --> of the page: where the published method stands in every scene, and the front of every scene.
"""
import pathlib
import sys

import runner


def number(text):
    return float(text) if text else float("nan")


def sound(row):
    return row["complete"] == "1" and row["outcome"] not in ("overlap", "escape", "blow-up")


def cost(row):
    return number(row[row["clock"] + "_s_per_s"])


def seconds(value):
    return f"{1e3 * value:.3g} ms" if value < 1 else f"{value:.3g} s"


def length(value):
    return f"{1e3 * value:.3g} mm" if value >= 1e-4 else f"{1e6 * value:.2g} µm"


def force(value):
    return f"{value:.3g} N" if value >= 1 else f"{1e3 * value:.3g} mN" if value >= 1e-4 else f"{1e6 * value:.2g} µN"


def best_at(rows, price, column):
    values = [number(r[column]) for r in rows if sound(r) and cost(r) <= price and r[column]]
    return min(values) if values else None


def published(scenes, references):
    lines = ["| scene | model | cost | outcome | tip | front at its cost | hand force (its rms) |", "|---|---|---|---|---|---|---|"]
    for name, rows in scenes.items():
        for row in rows:
            if row["published"] != "1":
                continue
            best = best_at(rows, cost(row), "tip_rms_m") if row["complete"] == "1" else None
            scale = references.get((name, "hand_force"))
            lines.append(f"| {name} | {row['model'].replace('published ', '')} | {seconds(cost(row))} | {row['outcome']}"
                         f"{'' if row['complete'] == '1' else ', stopped at ' + format(number(row['simulated_s']), '.3g') + ' s'} | "
                         f"{length(number(row['tip_rms_m'])) if row['tip_rms_m'] else '–'} | {length(best) if best else '–'} | "
                         f"{force(number(row['hand_force_rms_n'])) if row['hand_force_rms_n'] else '–'}"
                         f"{' (' + force(number(scale['scale'])) + ')' if scale else ''} |")
    return lines


def fronts(scenes, references):
    lines = ["| scene | reference known to | front: model, cost per second, tip error |", "|---|---|---|"]
    for name, rows in scenes.items():
        tip = references[(name, "tip")]
        front = sorted((r for r in rows if r["tip_front"] == "1"), key=cost)
        text = "; ".join(f"{r['model']}: {seconds(cost(r))}, {length(number(r['tip_rms_m']))}" for r in front)
        known = "analytic" if tip["convergence"] == "analytic" else length(number(tip["uncertainty"]))
        lines.append(f"| [{name}](../../docs/charts/chart-{name}.png) | {known} | {text if tip['charted'] == '1' else 'not charted: the reference ' + tip['convergence']} |")
    return lines


def replaced(text, mark, lines):
    begin, end = f"<!-- {mark} -->", "<!-- end -->"
    if begin not in text or end not in text[text.index(begin):]:
        sys.exit(f"chart_page.py: no {begin} … {end} in the page")
    at = text.index(begin) + len(begin)
    return text[:at] + "\n" + "\n".join(lines) + "\n" + text[text.index(end, at):]


def main():
    parser = runner.parser(__doc__, app=False)
    parser.add_argument("dir", type=pathlib.Path)
    parser.add_argument("--page", type=pathlib.Path, default=runner.RESULTS / "chart.md")
    options = parser.parse_args()
    scenes, references = {}, {}
    for reference in runner.read_rows(options.dir / "references.csv"):
        references[(reference["scene"], reference["observable"])] = reference
    for row in runner.read_rows(options.dir / "chart.csv"):
        if (row["scene"], "tip") in references:
            scenes.setdefault(row["scene"], []).append(row)
    text = options.page.read_text(encoding="utf-8")
    text = replaced(text, "published", published(scenes, references))
    text = replaced(text, "fronts", fronts(scenes, references))
    options.page.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
