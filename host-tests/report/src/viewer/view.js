/* A flight in three dimensions, from a record in the page or from the library itself (WebAssembly) in the page. */
"use strict";
const $ = (id) => document.getElementById(id);
const color = (name) => getComputedStyle(document.querySelector(".view")).getPropertyValue(`--${name}`).trim();

/* What is shown: rows of numbers by the names of their columns, and words from a time on. */
const flight = { names: [], at: {}, rows: [], words: [], plans: [], curves: null };

function decoded(id) {
    const text = atob($(id).textContent.trim());
    return Uint8Array.from(text, (c) => c.charCodeAt(0));
}

function named(names) {
    flight.names = names;
    flight.at = Object.fromEntries(names.map((name, i) => [name, i]));
}

/* Rows of a flat list. */
function rowsOf(numbers) {
    const wide = flight.names.length;
    return Array.from({ length: numbers.length / wide }, (_, i) => numbers.slice(i * wide, (i + 1) * wide));
}

/* Candidates of plans, of a flat list: a list of them for each time. */
function plansOf(numbers) {
    const [wide, all] = [flight.candidate.length, []];
    for (let i = 0; i < numbers.length; i += wide) {
        const one = Object.fromEntries(flight.candidate.map((name, k) => [name, numbers[i + k]]));
        if (all.length && all[all.length - 1][0].t_s === one.t_s) all[all.length - 1].push(one); else all.push([one]);
    }
    return all;
}

/* The last plan that was made up to a time. */
function planAt(t) {
    let [low, high] = [-1, flight.plans.length];
    while (high - low > 1) {
        const middle = (low + high) >> 1;
        if (flight.plans[middle][0].t_s <= t + 1e-9) low = middle; else high = middle;
    }
    return flight.plans[low] || [];
}

const get = (row, name) => row[flight.at[name]];
const vector = (row, stem, unit) => ["north", "east", "down"].map((axis) => get(row, `${stem}${axis}_${unit}`));

/* Airspeed below which an angle of attack says nothing [m/s]: as where plans are recorded. */
const SLOW = 1;
const alphaOf = (row) => get(row, "airspeed_m_s") > SLOW ? get(row, "wing_alpha_rad") : NaN;

/* The rows about a time, and how far it is between them. */
function about(t) {
    const rows = flight.rows;
    let [low, high] = [0, rows.length - 1];
    while (high - low > 1) {
        const middle = (low + high) >> 1;
        if (rows[middle][0] <= t) low = middle; else high = middle;
    }
    const span = rows[high][0] - rows[low][0];
    return [rows[low], rows[high], span > 0 ? Math.min(Math.max((t - rows[low][0]) / span, 0), 1) : 1];
}

/* The row at a time: straight between two; words of the last change. */
function rowAt(t) {
    const [a, b, part] = about(t);
    const row = a.map((x, i) => x + part * (b[i] - x));
    /* Angles go the shorter way, and a number that is missing on one side is that of the other. */
    for (const name of ["alpha_rad", "wing_alpha_rad", "theta_tilde_rad"]) {
        const i = flight.at[name];
        if (Math.abs(b[i] - a[i]) > Math.PI) row[i] = part < 0.5 ? a[i] : b[i];
    }
    const q = ["attitude_w", "attitude_x", "attitude_y", "attitude_z"].map((name) => flight.at[name]);
    const sign = q.reduce((sum, i) => sum + a[i] * b[i], 0) < 0 ? -1 : 1;
    const mixed = q.map((i) => a[i] + part * (sign * b[i] - a[i]));
    const length = Math.hypot(...mixed);
    q.forEach((i, k) => { row[i] = mixed[k] / length; });
    row.forEach((x, i) => { if (Number.isNaN(x)) row[i] = part < 0.5 ? a[i] : b[i]; });
    return row;
}

function wordsAt(t) {
    let said = ["", "", ""];
    for (const [from, words] of flight.words) {
        if (from > t + 1e-9) break;
        said = words;
    }
    return said;
}

/* North, east, down to the axes of the drawing: north, up, east. */
const world = ([north, east, down]) => new THREE.Vector3(north, -down, east);

/* Axes of the body in the drawing: belly, nose, right wing. */
function axes(row) {
    const [w, x, y, z] = ["attitude_w", "attitude_x", "attitude_y", "attitude_z"].map((name) => get(row, name));
    const nose = [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)];
    const right = [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)];
    const belly = [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)];
    return [world(belly), world(nose), world(right)];
}

/* The vehicle's weight [N]: known, or what a row says of it. */
function weight() {
    if (flight.curves) return flight.curves.weight_n;
    const row = flight.rows.find((row) => get(row, "thrust_to_weight") > 0.01);
    return row ? get(row, "true_thrust_n") / get(row, "thrust_to_weight") : NaN;
}

/* ---- the drawing ---- */
/* `due`: something other than the time has changed since the last frame. */
const drawing = { frames: 0, span: 2, ready: false, due: true };

function makeVehicle(opacity) {
    const group = new THREE.Group();
    const shape = (points, faces) => {
        const geometry = new THREE.BufferGeometry();
        geometry.setAttribute("position", new THREE.Float32BufferAttribute(points.flat(), 3));
        geometry.setIndex(faces.flat());
        geometry.computeVertexNormals();
        return geometry;
    };
    const material = (name, side) => new THREE.MeshLambertMaterial({ color: color(name), side, transparent: opacity < 1, opacity, depthWrite: opacity === 1 });
    const wing = shape([[0, 0.3, 0], [0, -0.22, 0.5], [0, -0.32, 0.5], [0, -0.2, 0], [0, -0.32, -0.5], [0, -0.22, -0.5]], [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]]);
    const [back, belly] = opacity < 1 ? ["grey", "grey"] : ["blue", "orange"];
    /* The triangles' normals point along the belly or against it; each side has its own colour. */
    group.add(new THREE.Mesh(wing, material(belly, 0)), new THREE.Mesh(wing, material(back, 1)));
    const body = new THREE.Mesh(new THREE.CylinderGeometry(0.025, 0.035, 0.62, 12), material("grey", 0));
    const nose = new THREE.Mesh(new THREE.ConeGeometry(0.025, 0.1, 12), material("grey", 0));
    nose.position.y = 0.36;
    const fin = shape([[0, -0.1, 0], [0, -0.32, 0], [-0.16, -0.34, 0], [-0.16, -0.26, 0]], [[0, 1, 2], [0, 2, 3]]);
    group.add(body, nose, new THREE.Mesh(fin, material(back, 2)));
    const disc = new THREE.Mesh(new THREE.CircleGeometry(0.16, 32), new THREE.MeshBasicMaterial({ color: color("grey"), side: 2, transparent: true, opacity: 0.25 * opacity, depthWrite: false }));
    disc.rotation.x = Math.PI / 2;
    disc.position.y = 0.4;
    group.add(disc);
    group.matrixAutoUpdate = true;
    return group;
}

function makeArrow(name) {
    const group = new THREE.Group();
    const material = new THREE.MeshBasicMaterial({ color: color(name) });
    const shaft = new THREE.Mesh(new THREE.CylinderGeometry(0.018, 0.018, 1, 8), material);
    const head = new THREE.Mesh(new THREE.ConeGeometry(0.055, 0.16, 12), material);
    group.add(shaft, head);
    const up = new THREE.Vector3(0, 1, 0);
    /* `v` in spans. */
    group.point = (v) => {
        const length = v.length();
        group.visible = Number.isFinite(length) && length > 0.03;
        if (!group.visible) return;
        group.quaternion.setFromUnitVectors(up, v.clone().divideScalar(length));
        const neck = Math.max(length - 0.16, 0.01);
        shaft.scale.y = neck;
        shaft.position.y = neck / 2;
        head.position.y = neck + 0.08;
        group.scale.setScalar(drawing.span);
    };
    return group;
}

function makeLine(name, dashed) {
    const material = dashed
        ? new THREE.LineDashedMaterial({ color: color(name), dashSize: 1.2, gapSize: 0.9 })
        : new THREE.LineBasicMaterial({ color: color(name) });
    const line = new THREE.Line(new THREE.BufferGeometry(), material);
    line.frustumCulled = false;
    return line;
}

function setLine(line, points) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(points), 3));
    line.geometry.dispose();
    line.geometry = geometry;
    if (line.material.isLineDashedMaterial) line.computeLineDistances();
}

function prepare() {
    const canvas = $("scene");
    drawing.scene = new THREE.Scene();
    drawing.camera = new THREE.PerspectiveCamera(45, 1, 0.1, 20000);
    drawing.scene.add(new THREE.HemisphereLight(0xffffff, 0x8a8a80, 2.4));
    const sun = new THREE.DirectionalLight(0xffffff, 1.2);
    sun.position.set(-3, 6, 2);
    drawing.scene.add(sun);
    drawing.vehicle = makeVehicle(1);
    drawing.ghost = makeVehicle(0.35);
    drawing.arrows = { thrust: makeArrow("green"), air: makeArrow("blue"), force: makeArrow("red"), asked: makeArrow("orange") };
    drawing.trail = makeLine("blue");
    drawing.path = makeLine("orange", true);
    drawing.track = makeLine("grey");
    drawing.drop = makeLine("grey", true);
    drawing.scene.add(drawing.vehicle, drawing.ghost, drawing.trail, drawing.path, drawing.track, drawing.drop, ...Object.values(drawing.arrows));
    try {
        drawing.renderer = new THREE.WebGLRenderer({ canvas, antialias: true });
    } catch (error) {
        problem(`This browser draws no three dimensions (${error.message}); the curves below are there all the same.`);
        return;
    }
    drawing.orbit = new THREE.OrbitControls(drawing.camera, canvas);
    drawing.orbit.enableDamping = false;
    drawing.orbit.addEventListener("change", () => { drawing.due = true; });
    drawing.orbit.maxPolarAngle = 0.53 * Math.PI;
    drawing.ready = true;
    paint();
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { paint(); charts(); plan(); surface(); drawStrip(); });
}

/* Colours of light and dark. */
function paint() {
    drawing.due = true;
    drawing.scene.background = new THREE.Color(color("sky"));
    drawing.scene.fog = new THREE.Fog(color("sky"), 150, 1500);
    const tint = (object, name) => object.traverse((part) => part.material && part.material.color.set(color(name)));
    for (const [arrow, name] of [["thrust", "green"], ["air", "blue"], ["force", "red"], ["asked", "orange"]]) tint(drawing.arrows[arrow], name);
    for (const [line, name] of [["trail", "blue"], ["path", "orange"], ["track", "grey"], ["drop", "grey"]]) drawing.scene && tint(drawing[line], name);
    if (drawing.grid) ground();
}

/* The ground lies at a round altitude under the lowest point. */
function ground() {
    if (drawing.grid) drawing.scene.remove(drawing.grid, drawing.plane);
    const step = drawing.span > 4 ? 20 : 10;
    const half = 400;
    drawing.grid = new THREE.GridHelper(2 * half * step / 10, 2 * half / 10, color("grey"), color("grey"));
    drawing.grid.material.transparent = true;
    drawing.grid.material.opacity = 0.3;
    drawing.plane = new THREE.Mesh(new THREE.PlaneGeometry(40000, 40000), new THREE.MeshBasicMaterial({ color: color("earth") }));
    drawing.plane.rotation.x = -Math.PI / 2;
    drawing.step = step;
    drawing.scene.add(drawing.grid, drawing.plane);
    level();
}

function level() {
    drawing.grid.position.y = drawing.floor + 0.02;
    drawing.plane.position.y = drawing.floor - 0.05;
}

/* Height over the ground at which a steered flight begins [m]. */
const ROOM = 20;

/* A record without positions has the way that its velocities make. */
function ways(rows) {
    const places = ["north", "east", "down"].map((axis) => flight.at[`${axis}_m`]);
    if (rows.some((row) => Number.isFinite(row[places[0]]))) return;
    const at = [0, 0, 0];
    rows.forEach((row, k) => {
        const passed = k ? row[0] - rows[k - 1][0] : 0;
        vector(row, "v_", "m_s").forEach((v, i) => {
            at[i] += Number.isFinite(v) ? v * passed : 0;
            row[places[i]] = at[i];
        });
    });
    $("lead").textContent += " It holds no positions: the way drawn is that of its velocities.";
}

/* A flight has been taken up: its size, ground, path, and where it is seen from. */
function take() {
    const rows = flight.rows;
    ways(rows);
    drawing.weight = weight();
    drawing.due = true;
    const lowest = Math.min(...rows.map((row) => -get(row, "down_m")));
    drawing.span = flight.curves ? Math.max(1.2, 2.2 * Math.sqrt(2 * flight.curves.k_a_kg_m / 1.225)) : 2;
    /* What is steered has room to sink. */
    drawing.floor = Math.floor((lowest - (clock.steering ? ROOM : 1.5 * drawing.span)) / 5) * 5;
    drawing.vehicle.scale.setScalar(drawing.span);
    drawing.ghost.scale.setScalar(drawing.span);
    ground();
    setLine(drawing.path, rows.flatMap((row) => world(vector(row, "path_", "m")).toArray()));
    const at = world(vector(rows[0], "", "m"));
    drawing.camera.position.copy(at).add(new THREE.Vector3(-3.2, 2.2, 7.4).multiplyScalar(drawing.span));
    drawing.last = at.clone();
    if (drawing.orbit) drawing.orbit.target.copy(at);
    $("scrub").max = rows[rows.length - 1][0];
    curvesAreThere();
    drawStrip();
}

const trail = { points: [], track: [], count: 0 };

/* The way up to a time. */
function drawTrail(t) {
    const rows = flight.rows;
    if (trail.of !== rows) Object.assign(trail, { of: rows, points: [], track: [], count: 0, drawn: -1 });
    while (trail.count < rows.length) {
        const p = world(vector(rows[trail.count++], "", "m"));
        trail.points.push(p.x, p.y, p.z);
        trail.track.push(p.x, drawing.floor + 0.05, p.z);
    }
    const [row] = about(t);
    const upTo = Math.min(rows.indexOf(row) + 1, trail.count);
    if (trail.count !== trail.drawn) {
        setLine(drawing.trail, trail.points);
        setLine(drawing.track, trail.track);
        trail.drawn = trail.count;
    }
    for (const line of [drawing.trail, drawing.track]) line.geometry.setDrawRange(0, upTo);
}

function place(object, at, [belly, nose, right]) {
    object.position.copy(at);
    object.quaternion.setFromRotationMatrix(new THREE.Matrix4().makeBasis(belly, nose, right));
}

function draw(t) {
    const row = rowAt(t);
    const span = drawing.span;
    const at = world(vector(row, "", "m"));
    if (-at.y > -drawing.floor - span) { drawing.floor = Math.floor((at.y - 1.5 * span) / 5) * 5; level(); trail.of = null; }
    const [belly, nose, right] = axes(row);
    place(drawing.vehicle, at, [belly, nose, right]);
    const { thrust, air, force, asked } = drawing.arrows;
    thrust.point(nose.clone().multiplyScalar(get(row, "thrust_to_weight")));
    const wind = vector(row, "wind_", "m_s");
    const velocity = vector(row, "v_", "m_s");
    air.point(world(velocity.map((v, i) => (v - wind[i]) / 10)));
    asked.point(world(vector(row, "path_v_", "m_s").map((v) => v / 10)));
    const [fp, tilde] = [get(row, "fp_n"), get(row, "theta_tilde_rad")];
    force.point(nose.clone().multiplyScalar(-Math.cos(tilde)).addScaledVector(belly, Math.sin(tilde)).multiplyScalar(fp / drawing.weight / 4));
    for (const arrow of Object.values(drawing.arrows)) arrow.position.copy(at);
    /* The reference model beside the right wing, in the plane of flight. */
    const theta = get(row, "model_theta_rad");
    const level = Math.hypot(right.x, right.z);
    drawing.ghost.visible = Number.isFinite(theta) && level > 0.05;
    if (drawing.ghost.visible) {
        const course = new THREE.Vector3(right.z / level, 0, -right.x / level);
        const up = new THREE.Vector3(0, 1, 0);
        const ahead = up.clone().multiplyScalar(Math.cos(theta)).addScaledVector(course, -Math.sin(theta));
        const under = course.clone().multiplyScalar(Math.cos(theta)).addScaledVector(up, Math.sin(theta));
        const side = under.clone().cross(ahead);
        place(drawing.ghost, at.clone().addScaledVector(side, 1.3 * span), [under, ahead, side]);
    }
    const legend = $("ghost");
    if (legend.hidden === drawing.ghost.visible) legend.hidden = !drawing.ghost.visible;
    setLine(drawing.drop, [at.x, at.y, at.z, at.x, drawing.floor, at.z]);
    drawTrail(t);
    /* The ground goes along by whole squares. */
    drawing.grid.position.x = Math.round(at.x / drawing.step) * drawing.step;
    drawing.grid.position.z = Math.round(at.z / drawing.step) * drawing.step;
    drawing.plane.position.x = at.x;
    drawing.plane.position.z = at.z;
    if (drawing.ready) {
        if ($("follow").checked) {
            const moved = at.clone().sub(drawing.last);
            drawing.camera.position.add(moved);
            drawing.orbit.target.copy(at);
        }
        drawing.last.copy(at);
        drawing.orbit.update();
        drawing.renderer.render(drawing.scene, drawing.camera);
        drawing.frames++;
    }
    drawing.due = false;
    state(row, t);
    return row;
}

/* A number with so many decimals, and no sign of zero. */
const fixed = (x, digits) => Number.isFinite(x) ? x.toFixed(digits).replace(/^-(0(\.0*)?)$/, "$1") : "–";
const degrees = (x) => x * 180 / Math.PI;

function state(row, t) {
    const [mode, phase, flags] = wordsAt(t);
    const v = vector(row, "v_", "m_s");
    const lines = [
        `speed ${fixed(Math.hypot(...v), 1)} m/s, in air ${fixed(get(row, "airspeed_m_s"), 1)} m/s`,
        `height ${fixed(-get(row, "down_m") - (clock.steering ? drawing.floor : 0), 1)} m, climb ${fixed(-v[2], 1)} m/s`,
        `α ${fixed(degrees(alphaOf(row)), 1)}${Number.isFinite(alphaOf(row)) ? "°" : ""}, thrust ${fixed(get(row, "thrust_to_weight"), 2)} of the weight`,
        `|F_p| ${fixed(get(row, "fp_n"), 1)} N, θ̃ ${fixed(degrees(get(row, "theta_tilde_rad")), 1)}°`,
        `off the path ${fixed(get(row, "position_error_m"), 2)} m, ${fixed(get(row, "velocity_error_m_s"), 2)} m/s`,
        [mode, phase, flags === "ok" ? "" : flags].filter(Boolean).join(", "),
    ];
    const chosen = planAt(t).find((one) => one.mark >= 2);
    if (chosen) lines.push(`plan: ${turning(chosen)}`);
    $("state").textContent = lines.join("\n");
    $("clock").textContent = `${fixed(t, 2)} of ${fixed(flight.rows[flight.rows.length - 1][0], 1)} s`;
}

/* Where a candidate turns to, in words. */
const turning = ({ theta_rad, alpha_rad }) => !Number.isFinite(theta_rad) ? "no turn, the servo alone"
    : `nose ${fixed(Math.abs(fromUp(theta_rad)), 0)}° ${fromUp(theta_rad) > 0 ? "behind" : "ahead"}${Number.isFinite(alpha_rad) ? `, α ${fixed(degrees(alpha_rad), 0).replace("-", "−")}°` : ""}`;
const fromUp = (theta) => degrees(Math.atan2(Math.sin(theta), Math.cos(theta)));

/* ---- curves ---- */
function canvas2d(id) {
    const canvas = $(id);
    const ratio = devicePixelRatio || 1;
    const [wide, high] = [canvas.clientWidth, canvas.clientHeight];
    if (canvas.width !== Math.round(wide * ratio) || canvas.height !== Math.round(high * ratio)) [canvas.width, canvas.height] = [Math.round(wide * ratio), Math.round(high * ratio)];
    const pen = canvas.getContext("2d");
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, wide, high);
    pen.font = "12px system-ui, sans-serif";
    return { canvas, pen, wide, high };
}

/* A chart with axes: x and y from, to; ticks at these steps. */
function axesOf(id, [x0, x1, dx], [y0, y1, dy]) {
    const { pen, wide, high } = canvas2d(id);
    const [left, right, top, bottom] = [42, wide - 10, 20, high - 24];
    const x = (value) => left + (value - x0) / (x1 - x0) * (right - left);
    const y = (value) => bottom - (value - y0) / (y1 - y0) * (bottom - top);
    pen.strokeStyle = color("edge") || "#888";
    pen.fillStyle = color("soft");
    pen.lineWidth = 1;
    pen.textAlign = "center";
    for (let i = Math.ceil(x0 / dx); i * dx <= x1 + 1e-9; i++) {
        pen.beginPath(); pen.moveTo(x(i * dx), top); pen.lineTo(x(i * dx), bottom); pen.stroke();
        pen.fillText(String(+(i * dx).toPrecision(6)), x(i * dx), high - 8);
    }
    pen.textAlign = "right";
    for (let i = Math.ceil(y0 / dy); i * dy <= y1 + 1e-9; i++) {
        pen.beginPath(); pen.moveTo(left, y(i * dy)); pen.lineTo(right, y(i * dy)); pen.stroke();
        pen.fillText(String(+(i * dy).toPrecision(6)), left - 6, y(i * dy) + 4);
    }
    const line = (points, name, width = 1.8, dash = []) => {
        pen.strokeStyle = name; pen.lineWidth = width; pen.setLineDash(dash);
        pen.save(); pen.beginPath(); pen.rect(left, top, right - left, bottom - top); pen.clip(); pen.beginPath();
        points.forEach(([a, b], i) => i ? pen.lineTo(x(a), y(b)) : pen.moveTo(x(a), y(b)));
        pen.stroke(); pen.restore(); pen.setLineDash([]);
    };
    const dot = (a, b, name, size = 4) => {
        if (!(a >= x0 && a <= x1 && b >= y0 && b <= y1)) return;
        pen.fillStyle = name; pen.beginPath(); pen.arc(x(a), y(b), size, 0, 7); pen.fill();
    };
    const ring = (a, b, name) => { pen.strokeStyle = name; pen.lineWidth = 1.4; pen.beginPath(); pen.arc(x(a), y(b), 4, 0, 7); pen.stroke(); };
    const legend = (entries) => {
        pen.textAlign = "left";
        let at = left;
        for (const [name, words] of entries) { pen.fillStyle = name; pen.fillText(words, at, 12); at += pen.measureText(words).width + 14; }
    };
    return { line, dot, ring, legend };
}

/* The colour of an acceleration. */
const hue = (a) => a === 0 ? color("ink") : a > 0 ? `hsl(${25 - 5 * a} 80% ${matchMedia("(prefers-color-scheme: dark)").matches ? 62 : 42}%)` : `hsl(${205 - 4 * a} 70% ${matchMedia("(prefers-color-scheme: dark)").matches ? 65 : 40}%)`;

let now = null;

/* The plan that was made last: what was looked at, and what came of it. */
function plan() {
    $("plan").hidden = !flight.plans.length;
    const all = planAt(clock.t);
    if (!all.length) return;
    const chosen = all.find((one) => one.mark >= 2);
    const known = all.filter((one) => Number.isFinite(one.cost_s));
    $("plan-words").textContent = `The plan made at ${fixed(all[0].t_s, 2)} s: each candidate is flown ahead by the believed vehicle; its errors on the way, and the time to close what is left of them, are its cost. `
        + `${all.length - 1} were looked at besides the plan in force; what costs more than the best so far is cut short (“dearer”). `
        + (chosen && chosen.mark === 3 ? "The plan in force is kept." : `Chosen: ${chosen ? turning(chosen) : "none"}.`);
    const top = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000].find((most) => known.every((one) => one.cost_s <= 0.85 * most)) || 1000;
    const c = axesOf("costs", [-180, 180, 60], [0, top, top / 5]);
    for (const one of all) {
        const name = one.mark >= 2 ? color("red") : one.mark === 1 ? color("blue") : color("grey");
        const [dear, turns] = [!Number.isFinite(one.cost_s), Number.isFinite(one.theta_rad)];
        const cost = dear ? 0.96 * top : one.cost_s;
        if (!turns) c.line([[-180, cost], [180, cost]], name, one.mark >= 2 ? 2.4 : 1.4, dear ? [2, 6] : [7, 4]);
        else if (dear) c.ring(fromUp(one.theta_rad), cost, name);
        else c.dot(fromUp(one.theta_rad), cost, name, one.mark >= 2 ? 6 : 4);
    }
    c.legend([[color("red"), "chosen"], [color("blue"), "in force"], [color("grey"), "ring: dearer, line: no turn"]]);
    const cells = (one) => [turning(one), one.push_over_s > 0 ? `${fixed(one.push_over_s, 2)} s` : "–", Number.isFinite(one.cost_s) ? `${fixed(one.cost_s, 3)} s` : "dearer", ["", "in force", "chosen", "in force, kept"][one.mark]];
    $("candidates").tBodies[0].replaceChildren(...all.map((one) => {
        const row = document.createElement("tr");
        if (one.mark >= 2) row.className = "chosen";
        for (const text of cells(one)) row.insertCell().textContent = text;
        return row;
    }));
}

/* The acceleration of the reference that the slider asks for [m/s²]. */
const cutNow = () => +$("cut").value;

function charts() {
    const curves = flight.curves;
    if (!curves) return;
    const of = (i) => curves.coefficients.map((row) => [row[0], row[i]]);
    const most = (list) => Math.max(...list.map((p) => Math.abs(p[1])));
    const [lift, drag, lambda] = [of(1), of(2), of(3)];
    const top = Math.ceil(Math.max(most(lift), most(drag), 1.5) * 2) / 2;
    const c = axesOf("coefficients", [-180, 180, 60], [-top, Math.max(top, Math.min(Math.ceil(most(lambda)), 6)), 1]);
    c.line(lift, color("blue")); c.line(drag, color("orange")); c.line(lambda, color("green"), 1.4, [5, 4]);
    c.legend([[color("blue"), "c_L"], [color("orange"), "c_D"], [color("green"), "λ"]]);
    const speeds = curves.cuts.flatMap((cut) => cut.folds.map((fold) => fold[1]));
    const fast = Math.min(40, Math.max(25, 1.6 * Math.max(0, ...speeds)));
    const e = axesOf("equilibria", [0, fast, 5], [0, 120, 30]);
    const f = axesOf("force", [0, fast, 5], [0, 12, 2]);
    for (const cut of curves.cuts) {
        const a = cut.acceleration_m_s2;
        const width = a === 0 ? 2.4 : 1.2;
        e.line(cut.points.map((p) => [p[1], p[0]]), hue(a), width);
        f.line(cut.points.map((p) => [p[1], p[2]]), hue(a), width);
        for (const [alpha, speed] of cut.folds) e.dot(speed, alpha, hue(a), 2.6);
    }
    const entries = curves.cuts.filter((cut) => [-6, -2, 0, 2, 6].includes(cut.acceleration_m_s2)).map((cut) => [hue(cut.acceleration_m_s2), `${cut.acceleration_m_s2}`.replace("-", "−")]);
    /* The acceleration of the slider, in pieces between gaps. */
    const pieces = [[]];
    for (const p of cutAt(cutNow())) if (p) pieces[pieces.length - 1].push(p); else pieces.push([]);
    for (const piece of pieces) {
        e.line(piece.map(([speed, alpha]) => [speed, alpha]), color("red"), 2, [6, 4]);
        f.line(piece.map(([speed, , force]) => [speed, force]), color("red"), 2, [6, 4]);
    }
    e.legend([...entries, [color("soft"), "m/s²; folds as dots"]]);
    f.legend([...entries, [color("soft"), "m/s²"]]);
    if (!now) return;
    const alpha = degrees(alphaOf(now));
    for (const list of [lift, drag, lambda]) {
        const near = list.find((p) => p[0] >= alpha);
        if (near) c.dot(alpha, near[1], color("red"));
    }
    e.dot(get(now, "airspeed_m_s"), Math.abs(alpha), color("red"), 5);
    f.dot(get(now, "airspeed_m_s"), get(now, "fp_n") / curves.weight_n, color("red"), 5);
}

/* The equilibria of a level acceleration, by α in degrees: [airspeed, α, |F_p| over the weight], or null where there is none. */
function cutAt(acceleration) {
    const { coefficients, weight_n, k_a_kg_m, delta_deg } = flight.curves;
    const epsilon = Math.atan(acceleration / 9.81);
    const apparent = weight_n / Math.cos(epsilon);
    return coefficients.filter(([alpha]) => alpha > -30 && alpha < 150).map(([alpha, lift, drag, lambda]) => {
        const at = (alpha + delta_deg) / 57.29577951308232;
        const [sin, cos] = [Math.sin(at), Math.cos(at)];
        const pressure = apparent * Math.cos(at + epsilon) / (lift * cos + drag * sin);
        const thrust = apparent * Math.sin(at + epsilon) + pressure * (drag * cos - lift * sin);
        /* Aligned thrust alone: the others are those that the law turns away from. */
        const force = thrust + lambda * pressure;
        return pressure >= 0 && force > 0 ? [Math.sqrt(pressure / k_a_kg_m), alpha, force / weight_n] : null;
    });
}

/* The surface of equilibria over airspeed and acceleration, from the back to the front, and a cut of it. */
function surface() {
    if (!flight.curves) return;
    const { pen, wide, high } = canvas2d("surface");
    const fast = 40, most = 120, depth = 6;
    const pixel = (speed, alpha, a) => [40 + (wide - 60) * (0.62 * speed / fast + 0.36 * (a + depth) / (2 * depth)),
        high - 34 - (high - 60) * (0.6 * alpha / most + 0.38 * (a + depth) / (2 * depth))];
    const path = (points) => { pen.beginPath(); points.forEach((p, i) => i ? pen.lineTo(...p) : pen.moveTo(...p)); };
    const inside = (p) => p && p[0] <= fast && p[1] >= 0 && p[1] <= most;
    pen.strokeStyle = color("edge") || "#888";
    pen.fillStyle = color("soft");
    for (const a of [depth, -depth]) { path([pixel(0, 0, a), pixel(fast, 0, a)]); pen.stroke(); }
    for (const speed of [0, 10, 20, 30, 40]) {
        path([pixel(speed, 0, -depth), pixel(speed, 0, depth)]); pen.stroke();
        const [x, y] = pixel(speed, 0, -depth);
        pen.textAlign = "center"; pen.fillText(String(speed), x, y + 16);
    }
    for (const a of [-6, 0, 6]) { const [x, y] = pixel(fast, 0, a); pen.textAlign = "left"; pen.fillText(`${a}`.replace("-", "−"), x + 6, y + 4); }
    for (const alpha of [0, 60, 120]) { const [x, y] = pixel(0, alpha, -depth); pen.textAlign = "right"; pen.fillText(String(alpha), x - 6, y + 4); }
    const cut = cutNow();
    $("cut-at").textContent = `${fixed(cut, 1)} m/s²`;
    const step = 0.5;
    let behind = null;
    for (let a = depth; a >= -depth - 1e-9; a -= step) {
        const points = cutAt(a);
        if (behind) for (let i = 0; i + 1 < points.length; i++) {
            const corners = [behind[i], behind[i + 1], points[i + 1], points[i]];
            if (!corners.every(inside)) continue;
            path(corners.map(([speed, alpha], k) => pixel(speed, alpha, k < 2 ? a + step : a)));
            pen.globalAlpha = 0.8; pen.fillStyle = color("paper") || "#fff"; pen.fill();
            pen.globalAlpha = 0.35; pen.fillStyle = hue(a); pen.fill();
            pen.globalAlpha = 1;
        }
        if (Math.abs(a - cut) < 1e-9) {
            const lines = [[]];
            for (const p of points) if (inside(p)) lines[lines.length - 1].push(pixel(p[0], p[1], a)); else lines.push([]);
            pen.strokeStyle = color("ink"); pen.lineWidth = 2.4;
            for (const line of lines) { path(line); pen.stroke(); }
            pen.lineWidth = 1;
        }
        behind = points;
    }
}

$("cut").addEventListener("input", () => { charts(); surface(); });

function curvesAreThere() {
    $("vehicle").hidden = !flight.curves;
    $("no-vehicle").hidden = !!flight.curves;
    charts();
    surface();
}

/* Speed, height, thrust and |F_p| over time, each over its own range. */
function drawStrip() {
    const { pen, wide, high } = canvas2d("strip");
    const rows = flight.rows;
    if (rows.length < 2) return;
    const end = rows[rows.length - 1][0] || 1;
    const lines = [
        ["speed [m/s]", "blue", (row) => Math.hypot(...vector(row, "v_", "m_s"))],
        ["height over the path [m]", "orange", (row) => get(row, "path_down_m") - get(row, "down_m")],
        ["thrust over the weight", "green", (row) => get(row, "thrust_to_weight")],
        ["|F_p| over the weight", "red", (row) => get(row, "fp_n") / drawing.weight],
    ];
    const each = high / lines.length;
    const thin = Math.max(1, Math.floor(rows.length / 1500));
    lines.forEach(([words, name, read], i) => {
        const values = [];
        for (let k = 0; k < rows.length; k += thin) values.push([rows[k][0], read(rows[k])]);
        const known = values.filter((p) => Number.isFinite(p[1]));
        if (!known.length) {
            pen.fillStyle = color("soft"); pen.textAlign = "left";
            pen.fillText(`${words}: not in the record`, 8, i * each + 12);
            return;
        }
        let [low, top] = [Math.min(0, ...known.map((p) => p[1])), Math.max(...known.map((p) => p[1]), 0.1)];
        const y = (v) => (i + 1) * each - 3 - (v - low) / (top - low) * (each - 16);
        pen.strokeStyle = color(name); pen.lineWidth = 1.5; pen.beginPath();
        known.forEach(([t, v], k) => { const x = t / end * wide; k ? pen.lineTo(x, y(v)) : pen.moveTo(x, y(v)); });
        pen.stroke();
        pen.fillStyle = color(name); pen.textAlign = "left";
        pen.fillText(`${words}: ${fixed(low, 1)} to ${fixed(top, 1)}`, 8, i * each + 12);
    });
    pen.strokeStyle = color("ink"); pen.lineWidth = 1;
    const x = clock.t / end * wide;
    pen.beginPath(); pen.moveTo(x, 0); pen.lineTo(x, high); pen.stroke();
}

/* ---- time ---- */
/* `steers`: it is to be steered; `steering`: it is. */
const clock = { t: 0, playing: false, last: null, drawn: null, slowly: 0, steering: false, steers: false };

function play(on) {
    clock.playing = on;
    clock.last = null;
    $("play").textContent = on ? "Pause" : "Play";
}

function seek(t) {
    clock.t = Math.min(Math.max(t, 0), flight.rows[flight.rows.length - 1][0]);
    $("scrub").value = clock.t;
    clock.stale = true;
}

function frame(stamp) {
    requestAnimationFrame(frame);
    if (flight.rows.length) goOn(stamp);
}

/* Goes on to a time of the page [ms], and draws what has changed. */
function goOn(stamp) {
    const passed = clock.last === null ? 0 : Math.min((stamp - clock.last) / 1000, 0.1) * +$("pace").value;
    clock.last = stamp;
    if (clock.playing && clock.steering) steered(passed);
    else if (clock.playing) {
        const end = flight.rows[flight.rows.length - 1][0];
        seek(clock.t + passed);
        if (clock.t >= end) play(false);
    }
    fit();
    /* A flight that stands costs nothing. */
    if (drawing.due || clock.t !== clock.drawn) {
        now = draw(clock.t);
        clock.drawn = clock.t;
    }
    /* What need not move at every frame. */
    if (clock.stale && stamp > clock.slowly + 120) { clock.slowly = stamp; clock.stale = false; charts(); plan(); drawStrip(); }
}

let size = "";
function fit() {
    if (!drawing.ready) return;
    const canvas = $("scene");
    const [wide, high] = [canvas.clientWidth, canvas.clientHeight];
    if (size === `${wide} ${high}`) return;
    size = `${wide} ${high}`;
    drawing.renderer.setPixelRatio(Math.min(devicePixelRatio || 1, 2));
    drawing.renderer.setSize(wide, high, false);
    drawing.camera.aspect = wide / high;
    drawing.camera.updateProjectionMatrix();
    drawing.due = clock.stale = true;
}

function problem(text) {
    $("problem").textContent = text;
    $("problem").hidden = !text;
}

$("play").addEventListener("click", () => {
    const atEnd = !clock.steering && clock.t >= flight.rows[flight.rows.length - 1][0];
    if (!clock.playing && atEnd) seek(0);
    play(!clock.playing);
});
$("scrub").addEventListener("input", () => { play(false); seek(+$("scrub").value); });
const point = (event) => { if (event.buttons && !clock.steering) { play(false); seek(event.offsetX / $("strip").clientWidth * flight.rows[flight.rows.length - 1][0]); } };
$("strip").addEventListener("pointerdown", point);
$("strip").addEventListener("pointermove", point);
addEventListener("resize", () => { clock.stale = true; surface(); });

/* ---- the library ---- */
let library = null;

/* Sliders: words, name, least, most, step, unit. */
const SLIDERS = [
    ["wind to the north", "north", -10, 10, 0.5, "m/s"],
    ["wind to the east", "east", -10, 10, 0.5, "m/s"],
    ["turbulence, wind at 20 ft", "turbulence", 0, 20, 0.1, "m/s"],
    ["mass believed", "mass", 0.5, 2, 0.05, "times"],
    ["lift believed", "lift", 0.5, 2, 0.05, "times"],
    ["thrust over weight", "thrust", 1.05, 3, 0.05, ""],
    ["lag of the rate loop", "rate", 0, 0.25, 0.01, "s"],
    ["lag of the thrust", "motor", 0, 0.25, 0.01, "s"],
];
const moved = {};
const sliders = {};

const text = () => new TextDecoder().decode(new Uint8Array(library.memory.buffer, library.answer(), library.answer_length()));
const numbers = () => Array.from(new Float64Array(library.memory.buffer, library.numbers(), library.numbers_length()));
const plans = () => plansOf(Array.from(new Float64Array(library.memory.buffer, library.plans(), library.plans_length())));

function asked(request) {
    const bytes = new TextEncoder().encode(JSON.stringify(request));
    const at = library.request(bytes.length);
    new Uint8Array(library.memory.buffer, at, bytes.length).set(bytes);
    if (!library.open()) throw Error(text());
    return JSON.parse(text());
}

/* Does what the library may refuse. */
function tried(of) {
    try { problem(""); return of(); } catch (error) { problem(error.message); play(false); return null; }
}

/* Flies anew, or says why the vehicle does not: then what was flown last stays. */
function flown(of) {
    try { problem(""); return of(); } catch (error) {
        problem(`This vehicle cannot fly that: ${error.message}. The flight shown is still the last one.`);
        play(false);
        return null;
    }
}

/* What is asked of the library. Sliders that were not moved stay the experiment's. */
function request(steered) {
    const set = ofParts() && $("kind").value ? [`plant.vehicle="${$("kind").value}"`] : [];
    return { experiment: $("experiment").value, set, sliders: moved, steered };
}

/* Whether the vehicle is one of parts, from which its thrust and lags follow. */
const ofParts = () => $("experiment").selectedOptions[0].dataset.parts === "true";

/* Sliders stand where the experiment has them. */
function stand(values) {
    for (const [, name, least, most, , unit] of SLIDERS) {
        const { slider, value } = sliders[name];
        const at = values[name];
        slider.disabled = at === null;
        value.textContent = at === null ? "the vehicle's" : `${+at.toPrecision(4)} ${unit}`.trim();
        if (at === null) continue;
        [slider.min, slider.max] = [Math.min(least, at), Math.max(most, at)];
        slider.value = at;
    }
}

/* Back to the experiment as it is. */
function unmove() {
    for (const name in moved) delete moved[name];
}

/* Again, as it is asked for now. */
const again = () => clock.steers ? steerBegins() : wholeFlight(true);

function opened(info) {
    $("kind-of").hidden = !info.of_parts;
    stand(info.sliders);
    named(info.names);
    flight.candidate = info.candidate;
    flight.curves = info.curves;
    $("text").hidden = false;
    $("text").querySelector("pre").textContent = info.text;
    $("same-of").textContent = clock.steering ? "The same vehicle, weather and controller on the command line, over the experiment's path:" : "The same flight on the command line:";
    $("same").textContent = `alula-sil fly ${info.command}`;
}

function wholeFlight(keep) {
    clock.steers = false;
    return flown(() => {
        const info = asked(request(false));
        if (!library.fly()) throw Error(text());
        const { words } = JSON.parse(text());
        clock.steering = false;
        opened(info);
        flight.rows = rowsOf(numbers());
        flight.plans = plans();
        flight.words = words;
        $("goals").hidden = $("keys").hidden = true;
        $("lead").textContent = info.description;
        take();
        seek(keep ? clock.t : 0);
        return info;
    });
}

/* ---- steering ---- */
const wish = { speed: 0, course: 0, climb: 0, loiter: false, sent: "" };
const keys = new Set();

function steerBegins() {
    clock.steers = true;
    flown(() => {
        /* Of what was steered the library has nothing left. */
        clock.steering = false;
        $("goals").hidden = $("keys").hidden = true;
        const info = asked(request(true));
        if (!library.begin() || !library.step(1)) throw Error(text());
        clock.steering = true;
        opened(info);
        flight.rows = rowsOf(numbers());
        flight.plans = plans();
        flight.words = JSON.parse(text());
        Object.assign(wish, { speed: 0, course: 0, climb: 0, loiter: false, sent: "", rate: info.control_rate_hz, owed: 0 });
        $("goals").hidden = $("keys").hidden = false;
        $("lead").textContent = `Steered by you, where this begins: ${info.description}`;
        take();
        seek(0);
        play(true);
    });
}

function aim(kind, target) {
    const key = `${kind} ${target}`;
    if (wish.sent === key) return;
    wish.sent = key;
    if (!library.goal(kind, ...target)) throw Error(text());
    const [north, east, down] = target;
    $("asked").textContent = kind === 3 ? `asked for: ${fixed(Math.hypot(north, east), 1)} m/s, course ${fixed(((degrees(Math.atan2(east, north)) % 360) + 360) % 360, 0)}°, climb ${fixed(-down, 1)} m/s` : ({ 1: "asked for: hover here", 2: "asked for: stop", 4: "asked for: a mission, a square of 250 m at 20 m/s" })[kind];
}

function hoverHere() {
    wish.speed = wish.climb = 0;
    wish.loiter = false;
    aim(1, vector(flight.rows[flight.rows.length - 1], "", "m"));
}

function stop() {
    wish.speed = wish.climb = 0;
    wish.loiter = false;
    aim(2, [0, 0, 0]);
}

function flyAt() {
    aim(3, [wish.speed * Math.cos(wish.course), wish.speed * Math.sin(wish.course), -wish.climb]);
}

/* Keys and sticks change the velocity asked for, over so much time of the flight. */
function hands(dt) {
    const pad = navigator.getGamepads && [...navigator.getGamepads()].find(Boolean);
    const stick = (i) => pad && Math.abs(pad.axes[i] || 0) > 0.15 ? pad.axes[i] : 0;
    const key = (more, less) => (keys.has(more) ? 1 : 0) - (keys.has(less) ? 1 : 0);
    const faster = key("ArrowUp", "ArrowDown") - stick(1);
    const turn = key("ArrowRight", "ArrowLeft") + stick(0);
    const climb = key("PageUp", "PageDown") - stick(3);
    if (wish.loiter) {
        /* At 2.5 m/s², of the 3 m/s² by which goals are flown to: of 16 m/s a circle of 102 m. */
        wish.course += 2.5 / wish.speed * dt;
        flyAt();
    }
    if (!faster && !turn && !climb && !wish.climbing) return;
    wish.loiter &&= !turn;
    wish.speed = Math.min(Math.max(wish.speed + 4 * faster * dt, 0), 24);
    wish.course += 0.6 * turn * dt;
    /* It sinks the slower the nearer the ground is, and not into it. */
    const [, , down] = vector(flight.rows[flight.rows.length - 1], "", "m");
    const over = Math.max(-down - drawing.floor - 1.5 * drawing.span, 0);
    wish.climb = Math.max(3 * climb, -0.5 * over);
    wish.climbing = climb !== 0;
    flyAt();
}

function steered(passed) {
    tried(() => {
        wish.owed = Math.min(wish.owed + passed * wish.rate, 0.25 * wish.rate);
        const steps = Math.floor(wish.owed);
        if (!steps) return;
        wish.owed -= steps;
        hands(steps / wish.rate);
        if (!library.step(steps)) throw Error(text());
        for (const [t, words] of JSON.parse(text())) {
            const last = flight.words[flight.words.length - 1];
            if (!last || last[1].join() !== words.join()) flight.words.push([t, words]);
        }
        const rows = rowsOf(numbers());
        flight.rows.push(...rows);
        flight.plans.push(...plans());
        $("scrub").max = flight.rows[flight.rows.length - 1][0];
        seek(Infinity);
    });
}

document.querySelectorAll("[data-goal]").forEach((button) => button.addEventListener("click", () => tried(() => {
    if (!clock.playing) play(true);
    const goal = button.dataset.goal;
    if (goal === "hover") return hoverHere();
    if (goal === "stop") return stop();
    if (goal === "mission") {
        wish.speed = wish.climb = 0;
        wish.loiter = false;
        wish.sent = "";
        return aim(4, [0, 0, 0]);
    }
    wish.loiter = goal === "loiter";
    wish.speed = goal === "cruise" ? 20 : Math.max(wish.speed, 16);
    flyAt();
})));
addEventListener("keydown", (event) => {
    if (event.target.matches("input, select")) return;
    if (event.key === " ") { event.preventDefault(); $("play").click(); return; }
    if (!clock.steering) return;
    if (/^(Arrow|Page)/.test(event.key)) { keys.add(event.key); event.preventDefault(); }
    if (event.key === "s") tried(stop);
    if (event.key === "h") tried(hoverHere);
});
addEventListener("keyup", (event) => keys.delete(event.key));
addEventListener("blur", () => keys.clear());

function withLibrary() {
    $("controls").hidden = false;
    const list = JSON.parse($("experiments").textContent);
    const { experiments, vehicles } = list;
    for (const name of vehicles) $("kind").append(new Option(name, name));
    $("kind").addEventListener("change", again);
    for (const { name, description, of_parts } of experiments) {
        const option = new Option(`${name}: ${description}`, name);
        option.dataset.parts = of_parts;
        $("experiment").append(option);
    }
    for (const [words, name, least, most, step, unit] of SLIDERS) {
        const label = document.createElement("label");
        const value = document.createElement("output");
        const slider = Object.assign(document.createElement("input"), { type: "range", id: `slider-${name}`, min: least, max: most, step });
        sliders[name] = { slider, value };
        slider.addEventListener("input", () => {
            moved[name] = +slider.value;
            value.textContent = `${slider.value} ${unit}`.trim();
            clearTimeout(slider.wait);
            slider.wait = setTimeout(again, 150);
        });
        label.append(words, value, slider);
        $("sliders").append(label);
    }
    $("experiment").addEventListener("change", () => { unmove(); $("kind").value = ""; wholeFlight(false); play(true); });
    $("unmove").addEventListener("click", () => { unmove(); $("kind").value = ""; again(); });
    $("whole").addEventListener("click", () => { wholeFlight(false); play(true); });
    $("steer").addEventListener("click", steerBegins);
}

/* ---- recorded flights ---- */
const held = JSON.parse($("held").textContent);
const floats = (text) => Array.from(new Float32Array(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer));

/* Takes up a flight that the page holds, at a time. */
function recall(name, t) {
    const one = held.flights.find((one) => one.name === name);
    named(one.names);
    flight.words = one.words;
    flight.curves = one.curves === null ? null : held.curves[one.curves];
    flight.candidate = one.candidate;
    flight.rows = rowsOf(floats(one.rows));
    flight.plans = plansOf(floats(one.plans));
    $("flights").value = name;
    $("lead").textContent = one.lead;
    take();
    seek(t);
}

function withFlights() {
    for (const { name } of held.flights) $("flights").append(new Option(name, name));
    $("which").hidden = held.flights.length < 2;
    $("flights").addEventListener("change", () => recall($("flights").value, clock.t));
}

/* ---- beginning ---- */
/* Moves by itself, unless its reader wants nothing to. */
const moves = () => !matchMedia("(prefers-reduced-motion: reduce)").matches;

/* What the address asks for, if it is there. */
function wanted(names) {
    const name = decodeURIComponent(location.hash.slice(1));
    return names.includes(name) ? name : null;
}

/* Shows what the address asks for, or else this. */
function show(otherwise) {
    if (held) recall(wanted(held.flights.map((one) => one.name)) ?? otherwise, 0);
    else {
        $("experiment").value = wanted([...$("experiment").options].map((option) => option.value)) ?? otherwise;
        unmove();
        wholeFlight(false);
    }
    play(moves());
}

(async () => {
    prepare();
    if ($("library")) {
        const { instance } = await WebAssembly.instantiate(decoded("library"), {});
        library = instance.exports;
        withLibrary();
    } else withFlights();
    const first = held ? held.flights[0].name : "mission";
    show(first);
    addEventListener("hashchange", () => show(first));
    requestAnimationFrame(frame);
})();

/* For tests. */
window.viewer = { flight, clock, drawing, seek, play, goOn, rowAt, wholeFlight, unmove, steerBegins, cutAt, planAt, plan, wish, steered, moved, asked, get library() { return library; } };
