/* Makes the drawn charts ones to explore. The curves are read from the drawings, which stay for print. */
(() => {
"use strict";
const narrow = () => innerWidth < 600;
const style = (element) => getComputedStyle(element);
const variable = (name) => style(document.documentElement).getPropertyValue(name).trim();
const numbers = (text) => text.split(" ").map(Number);

/* Long tables are closed where they would be listed cell by cell. */
const slim = matchMedia("(max-width: 600px)");
const fold = () => document.querySelectorAll(".long").forEach((part) => { part.open = !slim.matches; });
slim.addEventListener("change", fold);
fold();

/* Pieces of a path: [[x, y], …] in units. */
function pieces(data) {
    return data.split("M").slice(1).map((piece) => {
        const n = (piece.match(/-?\d+/g) || []).map(Number);
        const points = [[n[0], n[1]]];
        for (let i = 2; i + 1 < n.length; i += 2) {
            const [x, y] = points[points.length - 1];
            points.push([x + n[i], y + n[i + 1]]);
        }
        return points;
    });
}

/* The value of a curve, [[x, y], …] with increasing x, at x; null outside. */
function interpolate(curve, x) {
    const n = curve.length;
    if (!n || x < curve[0][0] || x > curve[n - 1][0]) return null;
    let [low, high] = [0, n - 1];
    while (high - low > 1) {
        const middle = (low + high) >> 1;
        if (curve[middle][0] <= x) low = middle; else high = middle;
    }
    const [a, b] = [curve[low], curve[high]];
    return b[0] > a[0] ? a[1] + (b[1] - a[1]) * (x - a[0]) / (b[0] - a[0]) : b[1];
}

const at = (curves, x) => {
    for (const curve of curves) {
        const y = interpolate(curve, x);
        if (y !== null) return y;
    }
    return null;
};

/* What a drawing shows. */
function read(svg) {
    const [x0, ux, y0, uy] = numbers(svg.dataset.units);
    const logarithmic = svg.classList.contains("logarithmic");
    const value = (y) => logarithmic ? 10 ** (y0 + y * uy) : y0 + y * uy;
    const series = [...svg.querySelectorAll("path[data-name]")].map((path) => {
        const all = pieces(path.getAttribute("d")).map((piece) => piece.map(([x, y]) => [x0 + x * ux, value(y)]));
        const kind = ["dash", "dots", "fan", "cells"].find((name) => path.classList.contains(name)) || "line";
        const one = { name: path.dataset.name, kind, path, curves: all };
        if (kind === "fan") {
            /* Forward along the lower edge, back along the upper. */
            const around = all[0] || [];
            let turn = 0;
            while (turn + 1 < around.length && around[turn + 1][0] > around[turn][0]) turn++;
            one.curves = [around.slice(0, turn + 1)];
            one.upper = [around.slice(turn + 1).reverse()];
        }
        return one;
    });
    const decimals = (unit) => Math.max(0, Math.round(-Math.log10(unit)));
    return {
        svg, series, logarithmic,
        title: svg.dataset.title, over: svg.dataset.over,
        x: numbers(svg.dataset.x),
        y: numbers(svg.dataset.y).map((y) => logarithmic ? 10 ** y : y),
        text: (y) => y === null ? "–" : logarithmic ? y.toPrecision(3) : y.toFixed(decimals(uy)).replace(/^-(0(\.0*)?)$/, "$1"),
        textX: (x) => x.toFixed(decimals(ux)),
        /* Charts over the same are explored together. */
        axis: `${svg.dataset.over} ${svg.dataset.x}`,
        time: svg.classList.contains("time"), angle: svg.classList.contains("angle"),
        levels: [...svg.querySelectorAll(".level")].map((e) => ({ at: +e.dataset.at, label: e.dataset.label, element: e })),
        bands: [...svg.querySelectorAll(".band")].map((e) => ({ from: +e.dataset.from, to: +e.dataset.to, label: e.dataset.label, element: e })),
        marks: [...svg.querySelectorAll(".mark")].map((e) => ({ at: numbers(e.dataset.at), label: e.dataset.label })),
    };
}

/* The strip's rows: name, and [[from, to, word, path], …]. */
function rows() {
    const svg = document.querySelector("svg.strip");
    if (!svg) return [];
    const all = [];
    for (const path of svg.querySelectorAll(".span")) {
        const row = all[+path.dataset.row] ||= { name: path.dataset.of, spans: [] };
        for (const m of path.getAttribute("d").matchAll(/M(\d+) 0h(\d+)/g)) {
            const from = m[1] / svg.dataset.units;
            row.spans.push([from, from + m[2] / svg.dataset.units, path.dataset.word, path]);
        }
    }
    svg.closest("figure").classList.add("replaced");
    return all;
}

const HIGH = 12;
const strip = rows();
const decimalSteps = [];
for (let power = -6; power < 7; power++) for (const factor of [1, 2, 5]) decimalSteps.push(+`${factor}e${power}`);
const angleSteps = decimalSteps.filter((step) => step <= 5).concat([15, 45, 90, 180, 360]);
const font = (size) => `${size}px system-ui, sans-serif`;
const built = [];

function element(parent, tag, properties) {
    const made = Object.assign(document.createElement(tag), properties);
    parent.append(made);
    return made;
}

function build(svg) {
    const chart = read(svg);
    const figure = svg.closest("figure");
    const live = element(figure, "div", { className: "live" });
    element(live, "div", { className: "title", textContent: chart.title });
    const legend = element(live, "div", { className: "legend" });
    const entry = (series) => {
        const item = element(legend, "span", {});
        const mark = element(item, "i", { className: series.upper ? "area" : series.kind });
        item.append(series.name);
        return { item, mark, value: element(item, "b", {}) };
    };
    chart.series.forEach((series) => { series.entry = entry(series); });
    const said = element(legend, "span", { className: "said" });
    const cursorText = element(said, "b", {});

    /* One table of all abscissas. Straight lines between points: nothing is made up. */
    const lines = chart.series.filter((series) => series.kind === "line" || series.kind === "dash");
    /* Between two pieces of a curve there is nothing: an abscissa where it has no value. */
    const gaps = (curves) => curves.slice(1).map((curve, i) => (curves[i][curves[i].length - 1][0] + curve[0][0]) / 2);
    const xs = [...new Set(lines.flatMap((s) => s.curves.flat().map((p) => p[0]).concat(gaps(s.curves))).concat(chart.x))].filter((x) => x >= chart.x[0] && x <= chart.x[1]).sort((a, b) => a - b);
    const data = [xs, ...lines.map((series) => xs.map((x) => at(series.curves, x)))];

    const rowsHere = chart.time ? strip : [];
    const color = (series) => style(series.path).color;
    const steps = chart.angle ? angleSteps : decimalSteps;
    const whole = (low, high) => low <= chart.x[0] && high >= chart.x[1];
    const range = (u) => {
        const { min, max } = u.scales.x;
        if (min == null || whole(min, max)) return chart.y;
        let [low, high] = [Infinity, -Infinity];
        for (const series of chart.series) {
            for (const curves of [series.curves, series.upper || []]) {
                const seen = curves.flat().filter((p) => p[0] >= min && p[0] <= max).map((p) => p[1]);
                for (const x of [min, max]) seen.push(at(curves, x));
                for (const y of seen) if (y !== null) { low = Math.min(low, y); high = Math.max(high, y); }
            }
        }
        if (!(low <= high)) return chart.y;
        if (chart.logarithmic) return [low / 1.2, high * 1.2];
        const room = 0.08 * (high - low) || 1e-3;
        return [low - room, high + room];
    };

    const clipped = (u, draw) => {
        const { left, top, width, height } = u.bbox;
        u.ctx.save();
        u.ctx.beginPath();
        u.ctx.rect(left, top, width, height);
        u.ctx.clip();
        draw(u.ctx, uPlot.pxRatio);
        u.ctx.restore();
    };
    const px = (u, x) => u.valToPos(x, "x", true);
    const py = (u, y) => u.valToPos(y, "y", true);

    function behind(u) {
        clipped(u, (ctx) => {
            const { left, width } = u.bbox;
            for (const band of chart.bands) {
                ctx.fillStyle = style(band.element).fill;
                ctx.globalAlpha = 0.14;
                ctx.fillRect(left, py(u, band.to), width, py(u, band.from) - py(u, band.to));
            }
            ctx.globalAlpha = 1;
            for (const series of chart.series.filter((s) => s.upper)) {
                ctx.fillStyle = color(series);
                ctx.beginPath();
                for (const [x, y] of series.curves[0].concat(series.upper[0].slice().reverse())) ctx.lineTo(px(u, x), py(u, y));
                ctx.fill();
            }
        });
    }

    function inFront(u) {
        const ratio = uPlot.pxRatio;
        const { left, top, width, height } = u.bbox;
        const [ink, soft] = [variable("--ink"), variable("--soft")];
        const written = [];
        clipped(u, (ctx) => {
            const note = (text, at) => {
                /* Above what it says, or below where there is no room. */
                const y = at < top + 16 * ratio ? at + 17 * ratio : at;
                if (!text || at < top || y > top + height || written.some((other) => Math.abs(other - y) < 14 * ratio)) return;
                written.push(y);
                ctx.fillStyle = soft;
                ctx.font = font(11.5 * ratio);
                ctx.textAlign = "right";
                ctx.textBaseline = "alphabetic";
                ctx.fillText(text, left + width - 4 * ratio, y - 3 * ratio);
            };
            for (const band of chart.bands) note(band.label, py(u, Math.min(band.to, u.scales.y.max)));
            for (const level of chart.levels) {
                const y = py(u, level.at);
                ctx.strokeStyle = style(level.element).color;
                ctx.lineWidth = 1.2 * ratio;
                ctx.setLineDash([2 * ratio, 4 * ratio]);
                ctx.beginPath();
                ctx.moveTo(left, y);
                ctx.lineTo(left + width, y);
                ctx.stroke();
                note(level.label, y);
            }
            ctx.setLineDash([]);
            for (const series of chart.series.filter((s) => s.kind === "dots")) {
                ctx.fillStyle = color(series);
                for (const [x, y] of series.curves.flat()) {
                    ctx.beginPath();
                    ctx.arc(px(u, x), py(u, y), 2 * ratio, 0, 7);
                    ctx.fill();
                }
            }
            const labels = [];
            for (const mark of chart.marks) {
                const [x, y] = [px(u, mark.at[0]), py(u, mark.at[1])];
                /* What a zoom has left outside has no label: it would lie on the axis. */
                if (x < left || x > left + width) continue;
                ctx.strokeStyle = ctx.fillStyle = ink;
                ctx.lineWidth = 1.6 * ratio;
                ctx.beginPath();
                ctx.arc(x, y, 4 * ratio, 0, 7);
                ctx.stroke();
                ctx.font = font(12 * ratio);
                const long = ctx.measureText(mark.label).width;
                const before = x + long + 10 * ratio > left + width;
                ctx.textAlign = "left";
                ctx.textBaseline = "middle";
                /* A label that is longer than the room on either side begins at the edge. */
                const [from, first] = [before ? Math.max(x - 8 * ratio - long, left + 2 * ratio) : x + 8 * ratio, y > top + height / 2 ? -12 : 12];
                /* Where no label is yet. */
                const free = (y) => labels.every(([other, otherLong, at]) => Math.abs(at - y) > 15 * ratio || other > from + long || from > other + otherLong);
                const at = [first, -first, 2.4 * first, -2.4 * first, 3.8 * first].map((dy) => y + dy * ratio).find(free) ?? y + first * ratio;
                labels.push([from, long, at]);
                ctx.fillText(mark.label, from, at);
            }
        });
        /* What the axis is, and the strip under it. */
        const ctx = u.ctx;
        ctx.save();
        ctx.fillStyle = soft;
        ctx.font = font(12 * ratio);
        ctx.textAlign = "center";
        ctx.textBaseline = "alphabetic";
        ctx.fillText(chart.over, left + width / 2, top + height + 35 * ratio);
        rowsHere.forEach((row, i) => {
            const y = top + height + (41 + i * (HIGH + 2)) * ratio;
            ctx.font = font(10.5 * ratio);
            ctx.textBaseline = "middle";
            ctx.textAlign = "right";
            ctx.fillStyle = soft;
            ctx.fillText(row.name, left - 6 * ratio, y + HIGH / 2 * ratio);
            for (const [from, to, word, path] of row.spans) {
                const a = Math.max(px(u, from), left);
                const b = Math.min(px(u, to), left + width);
                if (b <= a) continue;
                ctx.fillStyle = style(path).color;
                ctx.fillRect(a, y, Math.max(b - a, ratio), HIGH * ratio);
                ctx.textAlign = "left";
                if (ctx.measureText(word).width + 8 * ratio < b - a) {
                    ctx.fillStyle = path.classList.contains("quiet") ? soft : "#12161c";
                    ctx.fillText(word, a + 4 * ratio, y + HIGH / 2 * ratio + ratio);
                }
            }
        });
        ctx.restore();
    }

    function hover(u) {
        const inside = u.cursor.left >= 0;
        const x = inside ? u.posToVal(u.cursor.left, "x") : null;
        for (const series of chart.series) {
            let text = "";
            if (inside && series.kind !== "dots") {
                text = chart.text(at(series.curves, x));
                if (series.upper) text += " … " + chart.text(at(series.upper, x));
            }
            series.entry.value.textContent = text;
        }
        const words = rowsHere.map((row) => (row.spans.find(([from, to]) => x >= from && x <= to) || [])[2]).filter(Boolean);
        const name = chart.time ? "t" : chart.over.split(" [")[0];
        cursorText.textContent = inside ? [`${name} = ${chart.textX(x)}`, ...words].join(" · ") : "";
    }

    const size = () => ({ width: Math.max(figure.clientWidth - (narrow() ? 16 : 24), 200), height: (narrow() ? 230 : 270) + rowsHere.length * (HIGH + 2) });
    const axis = (more) => ({
        stroke: () => variable("--soft"), font: font(12), labelFont: font(12), incrs: steps,
        grid: { stroke: () => variable("--edge"), width: 1 }, ticks: { stroke: () => variable("--edge"), size: 4 },
        values: (u, all) => all.map((v) => v === null ? null : String(+v.toPrecision(6)).replace("-", "−")), ...more,
    });
    const yAxis = axis({ size: 54 });
    if (chart.logarithmic) {
        delete yAxis.incrs;
        /* uPlot's own ticks need a range that begins at a power of ten. */
        yAxis.splits = (u, axis, low, high) => {
            const all = [];
            for (let power = Math.floor(Math.log10(low)); 10 ** power <= high; power++)
                for (const lead of Math.log10(high / low) > 3 ? [1] : [1, 2, 5]) all.push(lead * 10 ** power);
            return all.filter((v) => v >= low && v <= high);
        };
    }
    const u = new uPlot({
        ...size(),
        padding: [8, 12, 0, 0],
        legend: { show: false },
        scales: { x: { time: false, range: (u, low, high) => low == null ? chart.x : [Math.max(low, chart.x[0]), Math.min(high, chart.x[1])] }, y: { auto: false, range: (u, low, high) => low == null ? chart.y : [low, high], distr: chart.logarithmic ? 3 : 1 } },
        cursor: {
            y: false, points: { show: false }, drag: { x: true, y: false },
            sync: { key: chart.axis, setSeries: false, scales: ["x", null] },
        },
        axes: [
            axis({ incrs: chart.over.includes("[°]") ? angleSteps : decimalSteps, size: 40 + rowsHere.length * (HIGH + 2), gap: 3 }),
            yAxis,
        ],
        series: [{}, ...lines.map((series) => ({
            label: series.name, stroke: () => color(series), width: 1.8, dash: series.kind === "dash" ? [7, 5] : undefined,
            points: { show: false }, spanGaps: false,
        }))],
        hooks: { drawAxes: [behind], draw: [inFront], setCursor: [hover], setScale: [(u, key) => {
            if (key !== "x") return;
            const [min, max] = range(u);
            u.setScale("y", { min, max });
            together(u, chart);
        }] },
    }, data, live);
    svg.classList.add("replaced");
    live.dataset.axis = chart.axis;
    built.push({ u, chart, size, legend });
    paint();
    function paint() { chart.series.forEach((series) => { series.entry.mark.style.color = color(series); }); }
    built[built.length - 1].paint = paint;
}

/* Every chart over the same axis shows the same of it. */
let spreading = false;
function together(from, chart) {
    if (spreading || from.status === 0) return;
    spreading = true;
    const { min, max } = from.scales.x;
    for (const other of built) {
        const now = other.u.scales.x;
        /* Charts set each other later, too: it must come to an end. */
        const same = Math.abs(now.min - min) + Math.abs(now.max - max) < 1e-6 * (max - min);
        if (other.chart.axis === chart.axis && other.u !== from && !same) other.u.setScale("x", { min, max });
    }
    spreading = false;
}

/* Drawings that stay: the point nearest to the pointer. */
function point(svg) {
    const figure = svg.closest("figure");
    const chart = read(svg);
    const tip = element(figure, "div", { className: "tip", hidden: true });
    svg.addEventListener("pointerleave", () => { tip.hidden = true; });
    svg.addEventListener("pointermove", (event) => {
        const path = chart.series[0] && chart.series[0].path;
        if (!path) return;
        const [x0, ux, y0, uy] = numbers(svg.dataset.units);
        const where = new DOMPoint(event.clientX, event.clientY).matrixTransform(path.getScreenCTM().inverse());
        const [x, y] = [x0 + where.x * ux, y0 + where.y * uy];
        let [name, best, seen] = ["", 12, [x, chart.logarithmic ? 10 ** y : y]];
        const area = event.target.dataset && event.target.dataset.name;
        if (area) name = area;
        const matrix = path.getScreenCTM();
        for (const series of chart.series) for (const [px, py] of series.kind === "cells" ? [] : series.curves.flat()) {
            const at = new DOMPoint((px - x0) / ux, ((chart.logarithmic ? Math.log10(py) : py) - y0) / uy).matrixTransform(matrix);
            const far = Math.hypot(at.x - event.clientX, at.y - event.clientY);
            if (far < best) [name, best, seen] = [series.name, far, [px, py]];
        }
        const inside = x >= chart.x[0] && x <= chart.x[1] && seen[1] >= chart.y[0] && seen[1] <= chart.y[1];
        tip.hidden = !inside;
        tip.textContent = `${name ? name + ": " : ""}${chart.textX(seen[0])}, ${chart.text(seen[1])}`;
        const frame = figure.getBoundingClientRect();
        const left = Math.min(event.clientX - frame.left + 14, frame.width - tip.offsetWidth - 4);
        tip.style.left = `${Math.max(left, 4)}px`;
        tip.style.top = `${event.clientY - frame.top + 14}px`;
    });
}

for (const svg of document.querySelectorAll("svg.chart")) {
    if (svg.classList.contains("explore")) build(svg); else point(svg);
}
if (built.length) document.body.classList.add("scripted");
const resize = () => { for (const { u, size } of built) u.setSize(size()); };
addEventListener("resize", resize);
resize();
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => built.forEach(({ u, paint }) => { paint(); u.redraw(false, true); }));
})();
