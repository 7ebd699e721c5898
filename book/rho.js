// The half-plane of rho, live: one point is a parallelogram, its two ratios, its two angles and
// its 4-web.  viewer.js loads it for pages with an element of class "rho".
(() => {
  const { hypot, atan2, sin, cos, tan, exp, asinh, sqrt, PI } = Math;
  // rho = x + iy -> the four numbers; angles in radians
  const shape = (x, y) => ({
    lam: hypot(1 + x, y) / hypot(1 - x, y),
    mu: 1 / hypot(x, y),
    theta: atan2(2 * y, (1 - x) * (1 + x) - y * y),
    theta0: atan2(y, x),
  });
  // the two angles -> the two ratios
  const ratios = (theta, theta0) => ({
    lam: exp(asinh(sin(theta) / tan(theta0))),
    mu: exp(asinh(sin(theta0) / tan(theta))),
  });
  const point = (theta, theta0) => {
    const { mu } = ratios(theta, theta0);
    return [cos(theta0) / mu, sin(theta0) / mu];
  };
  window.inetRho = { shape, ratios, point };

  const SCALE = 100; // of a unit of the half-plane
  const [WIDE, HIGH, LOW] = [2.5, 2.35, 0.06]; // the window, and how near rho comes to the line
  const SPECIAL = [ // degrees, words, side of the label
    [90, 90, "squares", 1], [90, 60, "3-web (90, 60)", 1], [90, 120, "3-web (90, 120)", -1],
    [60, 90, "3-web (60, 90)", -1], [120, 90, "3-web (120, 90)", 1],
  ];
  const degrees = (angle) => (angle * 180) / PI;
  const radians = (angle) => (angle * PI) / 180;

  const HTML = new Set(["table", "tbody", "tr", "th", "td", "label", "input", "div", "span", "i"]);
  const make = (parent, name, given = {}, words = "") => {
    const space = HTML.has(name) ? "http://www.w3.org/1999/xhtml"
      : "http://www.w3.org/2000/svg";
    const found = parent.appendChild(document.createElementNS(space, name));
    Object.entries(given).forEach(([key, value]) => found.setAttribute(key, value));
    found.textContent = words;
    return found;
  };
  const circle = (x, r, y = 0) => ({ cx: SCALE * x, cy: -SCALE * y, r: SCALE * r });

  // The curve of each number through a shape, as an SVG element
  const CURVES = {
    u: ({ mu }) => ["circle", circle(0, 1 / mu)],
    d1: ({ lam }) => {
      const gap = lam * lam - 1;
      if (Math.abs(gap) < 1e-4) return ["line", { x1: 0, y1: 0, x2: 0, y2: -4 * SCALE }];
      return ["circle", circle((lam * lam + 1) / gap, (2 * lam) / Math.abs(gap))];
    },
    v: ({ theta0 }) => ["line", {
      x1: 0, y1: 0, x2: 6 * SCALE * cos(theta0), y2: -6 * SCALE * sin(theta0),
    }],
    d2: ({ theta }) => ["circle", circle(0, 1 / sin(theta), -1 / tan(theta))],
  };
  const curve = (parent, family, given, look) => {
    const [name, place] = CURVES[family](given);
    return make(parent, name, { ...place, class: look, stroke: `var(--inet-${family})` });
  };

  // What does not move: a few curves of each family, special curves and points
  const still = (svg) => {
    const grid = make(svg, "g", { "clip-path": "url(#rho-window)" });
    for (const angle of [30, 60, 90, 120, 150]) {
      curve(grid, "v", { theta0: radians(angle) }, "thin");
      curve(grid, "d2", { theta: radians(angle) }, "thin");
    }
    for (const ratio of [2.5, 1.6, 1, 1 / 1.6, 1 / 2.5]) {
      curve(grid, "u", { mu: ratio }, "thin");
      curve(grid, "d1", { lam: ratio }, "thin");
    }
    make(grid, "circle", { ...circle(-1, sqrt(2)), class: "special equal" });
    make(grid, "circle", { ...circle(0, 1), class: "special" });
    make(grid, "line", { x1: 0, y1: 0, x2: 0, y2: -4 * SCALE, class: "special" });
    make(svg, "line", { x1: -WIDE * SCALE, y1: 0, x2: WIDE * SCALE, y2: 0, class: "axis" });
    for (const x of [-1, 0, 1]) {
      make(svg, "circle", { cx: SCALE * x, cy: 0, r: 3, class: "pole" });
      make(svg, "text", { x: SCALE * x, y: 16, class: "middle" }, String(x).replace("-", "\u2212"));
    }
    return make(svg, "g", { "clip-path": "url(#rho-window)" });
  };
  const labels = (svg, go) => {
    const words = (x, y, text, look) => make(
      svg, "text", { x: SCALE * x, y: -SCALE * y, class: `words ${look}` }, text,
    );
    words(-1.5, 1.47, "\u03b8 = \u03b8\u2080", "equal middle");
    words(0.97, 0.4, "rectangles, \u03bc = 1", "");
    words(0.05, 2.18, "rhombi, \u03bb = 1", "");
    for (const [theta, theta0, text, side] of SPECIAL) {
      const [x, y] = point(radians(theta), radians(theta0));
      const mark = make(svg, "circle", { cx: SCALE * x, cy: -SCALE * y, r: 4.5, class: "mark" });
      mark.addEventListener("click", () => go(x, y));
      const look = `${side < 0 ? "left" : ""} ${text === "squares" ? "" : "minor"}`;
      words(x + 0.09 * side, y, text, look);
    }
  };

  // The 4-web in the plane: lines in the directions 1, rho, 1 - rho and 1 + rho through the lattice
  const HALF = 100;
  const web = (svg, [x, y]) => {
    svg.replaceChildren();
    const size = 34 / sqrt(y); // all parallelograms have one area
    const at = (i, j) => [size * (i + j * x), -size * j * y];
    const rows = Math.min(Math.ceil((1.5 * HALF) / (size * y)), 40);
    const span = Math.min(Math.ceil(1.5 * (HALF / size + rows * Math.abs(x))) + 1, 160);
    const tiles = [];
    for (let j = -rows; j < rows; j += 1) {
      const middle = Math.round(-(j + 0.5) * x);
      const reach = Math.ceil(HALF / size) + 1;
      for (let i = middle - reach; i < middle + reach; i += 1) {
        const ends = [[i + 0.5, j], [i + 1, j + 0.5], [i + 0.5, j + 1], [i, j + 0.5]];
        tiles.push(`M ${ends.map(([a, b]) => at(a, b).map((z) => z.toFixed(1)).join(" ")).join(" L ")} Z`);
      }
    }
    make(svg, "path", { d: tiles.join(" "), fill: "var(--inet-inner)", opacity: 0.5 });
    const line = (family, [a, b], [c, d], wide) => make(svg, "line", {
      x1: a, y1: b, x2: c, y2: d, stroke: `var(--inet-${family})`, class: wide ? "" : "fine",
    });
    for (let j = -rows; j <= rows; j += 1) line("u", [-200, at(0, j)[1]], [200, at(0, j)[1]], true);
    for (let i = -span; i <= span; i += 1) {
      line("d1", at(i - rows, rows), at(i + rows, -rows));
      line("d2", at(i - rows, -rows), at(i + rows, rows));
      line("v", at(i, -rows), at(i, rows), true);
    }
  };

  const start = (element) => {
    const app = make(element, "div", { class: "rho-app" });
    const plane = make(app, "svg", {
      class: "rho-plane", tabindex: 0, role: "slider", "aria-label": "rho in the upper half-plane",
      viewBox: `${-WIDE * SCALE} ${-HIGH * SCALE} ${2 * WIDE * SCALE} ${HIGH * SCALE + 24}`,
    });
    const clip = make(plane, "clipPath", { id: "rho-window" });
    make(clip, "rect", {
      x: -WIDE * SCALE, y: -HIGH * SCALE, width: 2 * WIDE * SCALE, height: HIGH * SCALE,
    });
    const bold = still(plane);
    const handle = make(plane, "circle", { r: 8, class: "handle" });
    const figure = (title, box) => {
      const part = make(app, "div", { class: "rho-part" });
      const svg = make(part, "svg", { class: "rho-shape", viewBox: box, role: "img", "aria-label": title });
      make(part, "span", {}, title);
      return svg;
    };
    const quad = figure("the parallelogram", "-105 -84 210 168");
    const net = figure("the 4-web", "-100 -80 200 160");
    net.classList.add("rho-web");
    const side = make(app, "div", { class: "rho-part" });
    const table = make(side, "table", { class: "rho-numbers", "aria-live": "polite" });
    const body = make(table, "tbody");
    const row = ([name, family]) => {
      const found = make(body, "tr");
      const head = make(found, "th", { scope: "row" }, `${name} `);
      if (family) make(head, "i", { style: `background: var(--inet-${family})` });
      return make(found, "td");
    };
    const rows = { "\u03c1": "", "\u03bb": "d1", "\u03bc": "u", "\u03b8": "d2", "\u03b8\u2080": "v" };
    const cells = Object.entries(rows).map(row);
    const slider = (name) => {
      const label = make(side, "label", { class: "scene-slider" }, name);
      return make(label, "input", { type: "range", min: 5, max: 175, step: 1, "aria-label": name });
    };
    const inputs = { theta: slider("\u03b8"), theta0: slider("\u03b8\u2080") };

    let rho = element.dataset.rho.split(" ").map(Number);
    const show = () => {
      const [x, y] = rho;
      const found = shape(x, y);
      bold.replaceChildren();
      Object.keys(CURVES).forEach((family) => curve(bold, family, found, "bold"));
      handle.setAttribute("cx", SCALE * x);
      handle.setAttribute("cy", -SCALE * y);
      const turns = { theta: degrees(found.theta), theta0: degrees(found.theta0) };
      const real = x.toFixed(3).replace("-", "\u2212");
      const told = [`${real} + ${y.toFixed(3)} i`, found.lam.toFixed(4), found.mu.toFixed(4)];
      told.push(...Object.values(turns).map((angle) => `${angle.toFixed(2)}\u00b0`));
      cells.forEach((cell, k) => { cell.textContent = told[k]; });
      plane.setAttribute("aria-valuetext", told.join(", "));
      plane.setAttribute("aria-valuenow", x.toFixed(3));
      const { points, lines, arcs } = window.inetDrawn({ lam: found.lam, ...turns });
      quad.replaceChildren();
      make(quad, "polygon", { points, fill: "var(--inet-inner)", opacity: 0.55 });
      lines.forEach((line) => make(quad, "line", line));
      arcs.forEach(({ path, x: left, y: top, text }) => {
        make(quad, "path", { d: path, class: "arc" });
        make(quad, "text", { x: left, y: top }, text);
      });
      web(net, rho);
      Object.entries(inputs).forEach(([name, input]) => {
        if (document.activeElement !== input) input.value = turns[name];
      });
    };
    const go = (x, y) => {
      rho = [Math.max(-WIDE, Math.min(WIDE, x)), Math.max(LOW, Math.min(HIGH, y))];
      show();
    };
    labels(plane, go);
    plane.append(handle);

    const moved = (event) => {
      const { x, y } = new DOMPoint(event.clientX, event.clientY)
        .matrixTransform(plane.getScreenCTM().inverse());
      go(x / SCALE, -y / SCALE);
    };
    plane.addEventListener("pointerdown", (event) => {
      if (event.target.matches(".mark")) return;
      plane.setPointerCapture(event.pointerId);
      moved(event);
    });
    plane.addEventListener("pointermove", (event) => {
      if (plane.hasPointerCapture(event.pointerId)) moved(event);
    });
    plane.addEventListener("keydown", (event) => {
      const step = event.shiftKey ? 0.01 : 0.05;
      const way = {
        ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, step], ArrowDown: [0, -step],
      }[event.key];
      if (!way || event.ctrlKey || event.altKey || event.metaKey) return;
      event.preventDefault();
      go(rho[0] + way[0], rho[1] + way[1]);
    });
    Object.values(inputs).forEach((input) => input.addEventListener("input", () => {
      rho = point(...Object.values(inputs).map(({ value }) => radians(Number(value))));
      show();
    }));
    show();
    element.inetGo = go;
  };
  document.querySelectorAll(".rho").forEach(start);
})();
