// Nets that turn: a view of trame-vtk (vtk.js) for each element of class "scene" in a page.
// A scene is a script of its own, scenes/NAME.js, which calls inetScene(NAME, {...}): so it opens
// from a file, too.  What the numbers say was measured in Python (inetlib.measure) beforehand.
(() => {
  const ALIVE = 6; // views at a time: a browser has room for about sixteen
  const WIDTH = 1.5; // of the curves
  const CURVES = {
    u: [[1, 2], [0, 3]],
    v: [[0, 1], [3, 2]],
    d1: [[0, 2]],
    d2: [[1, 3]],
  };
  const TITLES = {
    inner: "parallelograms", u: "u-curves", v: "v-curves", d1: "diagonals d\u2081", d2: "diagonals d\u2082",
  };
  const scenes = {};
  window.inetScene = (name, scene) => { scenes[name] = scene; };

  const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer;
  const cells = (size, ends) => { // as vtk.js wants them: the size before each
    const found = new Uint32Array((ends.length / size) * (size + 1));
    for (let k = 0, at = 0; k < ends.length; k += size) {
      found[at++] = size;
      for (let j = 0; j < size; j += 1) found[at++] = ends[k + j];
    }
    return found;
  };

  // The geometry of a state: vertices, then the midpoints of all sides, as float32
  const build = (V, Q, polygon) => {
    const n = V.length / 3;
    const f = Q.length / 4;
    const all = new Float32Array(V.length + 12 * f);
    all.set(V);
    const ends = { inner: [], rest: [], u: [], v: [], d1: [], d2: [] };
    for (let k = 0; k < f; k += 1) {
      const q = Q.subarray(4 * k, 4 * k + 4);
      const m = [0, 1, 2, 3].map((j) => n + 4 * k + j);
      for (let j = 0; j < 4; j += 1) {
        for (let x = 0; x < 3; x += 1) {
          all[3 * m[j] + x] = (V[3 * q[j] + x] + V[3 * q[(j + 1) % 4] + x]) / 2;
        }
        ends.rest.push(q[j], m[j], m[(j + 3) % 4]);
      }
      ends.inner.push(m[0], m[1], m[2], m[0], m[2], m[3]);
      for (const [name, pairs] of Object.entries(CURVES)) {
        for (const [a, b] of pairs) ends[name].push(q[a], q[b]);
      }
    }
    const shown = { all, hole: cells(Math.max(polygon.length, 1), polygon) };
    for (const [name, list] of Object.entries(ends)) {
      shown[name] = cells(name in CURVES ? 2 : 3, list);
    }
    return shown;
  };

  // Vectors, and cameras made of them
  const plus = (a, b, factor = 1) => a.map((x, k) => x + factor * b[k]);
  const minus = (a, b) => plus(a, b, -1);
  const dot = (a, b) => a.reduce((sum, x, k) => sum + x * b[k], 0);
  const cross = (a, b) => [0, 1, 2].map((k) => (
    a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]
  ));
  const unit = (a) => a.map((x) => x / Math.sqrt(dot(a, a)));
  const about = (axis, angle, a) => {
    const [c, s] = [Math.cos(angle), Math.sin(angle)];
    return plus(plus(a.map((x) => c * x), cross(axis, a), s), axis, (1 - c) * dot(axis, a));
  };
  const turned = ({ position, focalPoint, viewUp, ...rest }, aside, up) => {
    const away = minus(position, focalPoint);
    const right = unit(cross(viewUp, away));
    const turn = (a) => about(right, -up, about(unit(viewUp), aside, a));
    return { ...rest, focalPoint, position: plus(focalPoint, turn(away)), viewUp: turn(viewUp) };
  };
  const carried = ({ position, focalPoint, viewUp, ...rest }, angle) => { // around the upright axis
    const turn = (a) => about([0, 0, 1], angle, a);
    const place = plus(focalPoint, turn(minus(position, focalPoint)));
    return { ...rest, focalPoint, position: place, viewUp: turn(viewUp) };
  };
  const nearer = ({ position, focalPoint, ...rest }, factor) => (
    { ...rest, focalPoint, position: plus(focalPoint, minus(position, focalPoint), 1 / factor) }
  );
  // A camera that sees the net of another state as this one sees its own
  const following = ({ position, focalPoint, ...rest }, from, to) => {
    const far = (camera) => Math.hypot(...minus(camera.position, camera.focalPoint));
    const ratio = far(to) / far(from);
    const focus = plus(to.focalPoint, minus(focalPoint, from.focalPoint), ratio);
    const place = plus(focus, minus(position, focalPoint), ratio);
    return { ...rest, focalPoint: focus, position: place };
  };

  // The colours of the page, as its style sheet has them now
  const palette = (element) => {
    const probe = element.appendChild(document.createElement("i"));
    const found = {};
    for (const name of ["paper", "inner", "rest", "singular", ...Object.keys(CURVES)]) {
      probe.style.color = `var(--inet-${name})`;
      const parts = getComputedStyle(probe).color.match(/[\d.]+/g).slice(0, 3);
      found[name] = parts.map((part) => part / 255);
    }
    probe.remove();
    return found;
  };

  // The parallelogram of a shape: its sides run along d1 and d2, its diagonals along u and v
  const HALF = 62; // the longest half diagonal; y points down
  const corners = ({ lam, theta }) => {
    const turn = (theta * Math.PI) / 180;
    const [x, y] = [lam * Math.cos(turn), lam * Math.sin(turn)];
    const all = [[-1 - x, -y], [1 - x, -y], [1 + x, y], [x - 1, y]];
    const size = HALF / Math.max(...all.map((a) => Math.hypot(...a)));
    return all.map((a) => [a[0] * size, -a[1] * size]);
  };
  const SIDES = [[0, 1, "d1"], [3, 2, "d1"], [1, 2, "d2"], [0, 3, "d2"], [0, 2, "u"], [1, 3, "v"]];
  const sides = (all) => SIDES.map(([p, q, name]) => (
    { x1: all[p][0], y1: all[p][1], x2: all[q][0], y2: all[q][1], stroke: `var(--inet-${name})` }
  ));
  const crosses = ({ x1, y1, x2, y2 }, [x, y], [w, h]) => { // a line and a box of half size w, h
    let [low, high] = [0, 1];
    for (const [start, step, centre, half] of [[x1, x2 - x1, x, w], [y1, y2 - y1, y, h]]) {
      const ends = [(centre - half - start) / step, (centre + half - start) / step];
      if (step === 0 && Math.abs(start - centre) > half) return false;
      if (step !== 0) [low, high] = [Math.max(low, Math.min(...ends)), Math.min(high, Math.max(...ends))];
    }
    return low < high;
  };
  // An arc at a corner with its words: the first place along its bisector that is on no line
  const arc = (lines, apex, p, q, radius, text, way) => {
    const [s, t] = [p, q].map(([x, y]) => Math.atan2(y - apex[1], x - apex[0]));
    const wide = (((s - t) % (2 * Math.PI)) + 2 * Math.PI) % (2 * Math.PI);
    const at = (turn, r) => [apex[0] + r * Math.cos(turn), apex[1] + r * Math.sin(turn)];
    const box = [3.2 * text.length + 2, 7.5];
    let r = 0;
    const place = () => at(s - wide / 2 + (way < 0 ? Math.PI : 0), r);
    while (lines.some((line) => crosses(line, place(), box)) || (way > 0 && r < radius + 8)) r += 1;
    const [x, y] = place();
    const path = `M ${at(s, radius)} A ${radius} ${radius} 0 0 0 ${at(s - wide, radius)}`;
    return { path, x, y, text };
  };
  const drawn = (shape) => {
    const all = corners(shape);
    const lines = sides(all);
    const words = (sign, angle) => `${sign} ${Number(angle.toFixed(1))}\u00b0`;
    const arcs = [
      arc(lines, all[0], all[1], all[3], 17, words("\u03b8", shape.theta), -1),
      arc(lines, [0, 0], all[2], all[3], 13, words("\u03b8\u2080", shape.theta0), 1),
    ];
    return { points: all.join(" "), lines, arcs };
  };
  window.inetDrawn = drawn; // rho.js draws the same

  const small = (degrees) => (degrees < 0.001 ? "below 0.001\u00b0" : `${degrees.toFixed(3)}\u00b0`);
  const numbers = ({ theta, theta0, lam, mu, off, faces, flips, darts }) => ({
    "\u03b8": `${theta.toFixed(2)}\u00b0`,
    "\u03b8\u2080": `${theta0.toFixed(2)}\u00b0`,
    "\u03bb": lam.toFixed(4),
    "\u03bc": mu.toFixed(4),
    "largest deviation": small(off),
    "quads": faces,
    "flipped, darts": `${flips}, ${darts}`,
  });

  const TEMPLATE = `
    <div class="scene-left">
      <div class="scene-view" tabindex="0" role="img" @keydown="press"
          :aria-label="scene.words + ' Arrow keys turn it, + and - zoom.'">
        <div class="scene-canvas" :class="{ ready }" ref="canvas">
          <vtk-view ref="view" :key="theme" :background="colours.paper"
              :interactor-settings="buttons" @reset-camera="aim()">
            <vtk-geometry-representation v-for="layer in layers" :key="layer.name"
                :property="layer.property" :actor="layer.actor" :mapper="layer.mapper">
              <vtk-polydata :key="at" :points="shown.all" v-bind="layer.cells"/>
            </vtk-geometry-representation>
          </vtk-view>
        </div>
      </div>
      <div class="scene-tools">
        <button type="button" aria-label="nearer" @click="zoom(1.25)">+</button>
        <button type="button" aria-label="farther" @click="zoom(0.8)">\u2212</button>
        <button type="button" :aria-pressed="turning" @click="turning = !turning">
          {{ turning ? "stop" : "turn" }}
        </button>
        <button type="button" @click="front">front view</button>
      </div>
    </div>
    <div class="scene-side">
      <svg viewBox="-105 -84 210 168" class="scene-parallelogram" role="img"
          :aria-label="'its parallelogram, enlarged: theta ' + state.theta.toFixed(0) +
            ', theta0 ' + state.theta0.toFixed(0) + ' degrees'">
        <polygon :points="shape.points" fill="var(--inet-inner)" opacity="0.55"/>
        <line v-for="line in shape.lines" v-bind="line"/>
        <template v-for="arc in shape.arcs">
          <path :d="arc.path" class="arc"/>
          <text :x="arc.x" :y="arc.y">{{ arc.text }}</text>
        </template>
      </svg>
      <label v-if="scene.states.length > 1" class="scene-slider">
        {{ scene.parameter }}: <b>{{ state.label }}</b>
        <input type="range" min="0" :max="scene.states.length - 1" v-model.number="at"
          :aria-label="scene.parameter" :aria-valuetext="state.label">
      </label>
      <table class="scene-numbers" aria-live="polite">
        <tbody>
          <tr v-for="(value, name) in numbers"><th scope="row">{{ name }}</th><td>{{ value }}</td></tr>
        </tbody>
      </table>
      <div class="scene-families" role="group" aria-label="what is shown">
        <label v-for="(title, name) in titles">
          <input type="checkbox" v-model="on[name]" :name="name">
          <i :class="name" :style="{ background: 'var(--inet-' + name + ')' }"></i>{{ title }}
        </label>
      </div>
    </div>
    <p class="scene-note">{{ scene.note }}</p>`;

  const component = (scene, kept, element) => ({
    template: TEMPLATE,
    data: () => ({
      scene: Vue.markRaw(scene),
      at: kept.at ?? scene.first,
      ready: false,
      theme: 0,
      turning: kept.turning ?? ("turn" in element.dataset
        && !matchMedia("(prefers-reduced-motion: reduce)").matches),
      colours: Vue.markRaw(palette(element)),
      on: kept.on ?? { inner: true, u: true, v: true, d1: false, d2: false },
      titles: TITLES,
      buttons: [
        { button: 1, action: "Rotate" },
        { button: 2, action: "Pan" },
        { button: 3, action: "Zoom" },
        { button: 1, action: "Pan", shift: true },
      ],
    }),
    computed: {
      state() { return this.scene.states[this.at]; },
      shape() { return drawn(this.state); },
      numbers() { return numbers(this.state); },
      shown() {
        const { V, faces, Q = this.scene.Q } = this.state;
        const quads = new Uint16Array(bytes(Q)).subarray(0, 4 * faces); // shorter webs are parts
        return Vue.markRaw(build(new Float32Array(bytes(V)), quads, this.scene.polygon));
      },
      layers() {
        const { shown, on, colours } = this;
        const face = (name, color) => ({
          name, mapper: { resolveCoincidentTopology: 1 }, actor: { visibility: true },
          cells: { polys: shown[name] },
          property: { color, interpolation: 0, ambient: 0.4, diffuse: 0.65, specular: 0.04 },
        });
        const line = (name) => ({
          name, mapper: {}, actor: { visibility: on[name] }, cells: { lines: shown[name] },
          property: {
            color: colours[name], lighting: false, lineWidth: WIDTH * Math.max(devicePixelRatio, 1),
          },
        });
        const layers = [face("rest", colours.rest), ...Object.keys(CURVES).map(line)];
        if (this.scene.polygon.length) layers.push(face("hole", colours.singular));
        return [face("inner", on.inner ? colours.inner : colours.rest), ...layers];
      },
    },
    watch: {
      turning(on) { if (on) this.spin(); },
      at(to, from) {
        const { states } = this.scene;
        const camera = following(this.$refs.view.getCamera(), states[from].camera, states[to].camera);
        this.aim(camera);
      },
    },
    mounted() {
      const { canvas } = this.$refs;
      if (this.turning) setTimeout(this.spin, 300);
      canvas.addEventListener("pointerdown", () => { this.turning = false; }, { capture: true });
      canvas.addEventListener("wheel", (event) => { // the page scrolls on; with ctrl the net is near
        event.stopPropagation();
        if (!event.ctrlKey) return;
        event.preventDefault();
        this.zoom(Math.exp(-Math.sign(event.deltaY) * 0.12));
      }, { capture: true, passive: false });
      for (const name of ["keydown", "keypress"]) { // keys of vtk.js that would change the look
        canvas.addEventListener(name, (event) => event.stopPropagation(), { capture: true });
      }
      canvas.querySelectorAll("[tabindex]").forEach((inner) => { inner.tabIndex = -1; });
      setTimeout(() => { this.ready = true; }, 150);
    },
    methods: {
      aim(camera = kept.camera ?? this.state.camera) {
        this.$refs.view?.setCamera({ ...camera, centerOfRotation: camera.focalPoint });
      },
      front() {
        kept.camera = undefined;
        this.turning = false;
        this.aim(this.state.camera);
      },
      zoom(factor) { this.aim(nearer(this.$refs.view.getCamera(), factor)); },
      spin() { // twelve degrees a second, as long as it is seen
        let last = 0;
        const turn = (now) => {
          if (!this.turning || element.inet !== this) return;
          if (last && !away(element)) {
            const angle = (Math.min(now - last, 100) / 1000) * 0.21;
            this.aim(carried(this.$refs.view.getCamera(), angle));
          }
          last = now;
          kept.frame = requestAnimationFrame(turn);
        };
        cancelAnimationFrame(kept.frame);
        kept.frame = requestAnimationFrame(turn);
      },
      press(event) {
        const step = Math.PI / 18;
        const turn = {
          ArrowLeft: [step, 0], ArrowRight: [-step, 0], ArrowUp: [0, -step], ArrowDown: [0, step],
        }[event.key];
        if (event.ctrlKey || event.metaKey || event.altKey || event.target !== event.currentTarget) return;
        if (turn) this.aim(turned(this.$refs.view.getCamera(), ...turn));
        else if ("+=".includes(event.key)) this.zoom(1.25);
        else if (event.key === "-") this.zoom(0.8);
        else return;
        this.turning = false;
        event.preventDefault();
      },
      keep() { // what a view that is made again begins with
        const { at, on, turning } = this;
        Object.assign(kept, { at, on: { ...on }, turning, camera: this.$refs.view.getCamera() });
      },
      repaint() { // a view has its background from the start
        this.keep();
        const old = element.querySelector("canvas");
        this.colours = Vue.markRaw(palette(element));
        this.theme += 1;
        this.$nextTick(() => freed(old));
      },
    },
  });

  // A page without a scene loads nothing; one with scenes loads the viewer when the first is near
  const folder = new URL(".", document.currentScript.src).href;
  const loaded = {};
  const load = (file) => loaded[file] ??= new Promise((resolve, reject) => {
    const script = document.createElement("script");
    script.src = folder + file;
    script.onload = resolve;
    script.onerror = reject;
    document.head.append(script);
  });

  const freed = (canvas) => { // a browser keeps the contexts of removed canvases for long
    const context = canvas?.getContext("webgl2") ?? canvas?.getContext("webgl");
    context?.getExtension("WEBGL_lose_context")?.loseContext();
  };
  const possible = () => {
    const canvas = document.createElement("canvas");
    const found = canvas.getContext("webgl2");
    if (found) freed(canvas);
    return Boolean(found);
  };

  const alive = new Set();
  const still = (element, words) => { // the picture stays, or is all there is
    if (!element.querySelector(":scope > p")) element.append(document.createElement("p"));
    element.querySelector(":scope > p").textContent = words;
  };
  const away = (element) => {
    const { top, bottom } = element.getBoundingClientRect();
    return Math.max(-bottom, top - innerHeight, 0);
  };

  const unmount = (element) => {
    alive.delete(element);
    element.style.minHeight = `${element.offsetHeight}px`; // nothing in the page moves
    element.inet.keep();
    const canvas = element.querySelector("canvas");
    element.inetApp.unmount();
    freed(canvas);
    element.querySelector(".scene-app").remove();
    delete element.inet;
    element.querySelectorAll(":scope > img").forEach((image) => { image.hidden = false; });
  };

  const mount = async (element) => {
    const name = element.dataset.scene;
    await load("vue.global.js");
    await Promise.all([load("trame-vtk.js"), load(`scenes/${name}.js`)]);
    if (element.inet || !element.inetNear) return;
    if (alive.size >= ALIVE) unmount([...alive].sort((a, b) => away(b) - away(a))[0]);
    element.inetKept ??= {};
    const place = document.createElement("div");
    place.className = "scene-app";
    element.append(place);
    element.inetApp = Vue.createApp(component(scenes[name], element.inetKept, element));
    element.inetApp.use(vue_vtk);
    element.inet = Vue.markRaw(element.inetApp.mount(place));
    element.querySelectorAll(":scope > img").forEach((image) => { image.hidden = true; });
    element.style.minHeight = "";
    alive.add(element);
  };

  const start = () => {
    if (document.querySelector(".rho")) load("rho.js");
    const found = document.querySelectorAll(".scene");
    if (!found.length) return;
    if (!possible()) {
      found.forEach((element) => still(
        element, "This browser shows no pictures in space (WebGL), so the net stands still here.",
      ));
      return;
    }
    const near = new IntersectionObserver((seen) => {
      for (const { isIntersecting, target } of seen) {
        target.inetNear = isIntersecting;
        if (isIntersecting && !target.inet) {
          mount(target).catch(() => still(target, "The files of this net are not there."));
        }
      }
    }, { rootMargin: "300px" });
    found.forEach((element) => near.observe(element));
    new MutationObserver(() => alive.forEach((element) => element.inet.repaint()))
      .observe(document.documentElement, { attributeFilter: ["data-theme"] });
  };
  if (document.readyState === "loading") document.addEventListener("DOMContentLoaded", start);
  else start();
})();
