// Nets that turn: a view of trame-vtk (vtk.js) for each element of class "scene" in a page.
// A scene is a script of its own, scenes/NAME.js, which calls inetScene(NAME, {...}): so it opens
// from a file, too.  What the numbers say was measured in Python (inetlib.measure) beforehand.
(() => {
  const scenes = {};
  window.inetScene = (name, scene) => { scenes[name] = scene; };

  const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer;
  const points = (text) => new Float32Array(bytes(text));
  const cells = (size, ends) => {
    const found = new Uint32Array((ends.length / size) * (size + 1));
    for (let k = 0, at = 0; k < ends.length; k += size) {
      found[at++] = size;
      for (let j = 0; j < size; j += 1) found[at++] = ends[k + j];
    }
    return found;
  };
  const FAMILIES = {
    u: [[1, 2], [0, 3]],
    v: [[0, 1], [3, 2]],
    d1: [[0, 2]],
    d2: [[1, 3]],
  };

  // The geometry of a state: vertices and the midpoints of all sides, as float32
  const build = (V, Q) => {
    const n = V.length / 3;
    const f = Q.length / 4;
    const all = new Float32Array(V.length + 12 * f);
    all.set(V);
    const inner = [];
    const rest = [];
    const lines = { u: [], v: [], d1: [], d2: [] };
    for (let k = 0; k < f; k += 1) {
      const q = Q.subarray(4 * k, 4 * k + 4);
      const m = [0, 1, 2, 3].map((j) => n + 4 * k + j);
      for (let j = 0; j < 4; j += 1) {
        for (let x = 0; x < 3; x += 1) {
          all[3 * m[j] + x] = (V[3 * q[j] + x] + V[3 * q[(j + 1) % 4] + x]) / 2;
        }
        rest.push(q[j], m[j], m[(j + 3) % 4]);
      }
      inner.push(m[0], m[1], m[2], m[0], m[2], m[3]);
      for (const [name, pairs] of Object.entries(FAMILIES)) {
        for (const [a, b] of pairs) lines[name].push(q[a], q[b]);
      }
    }
    const shown = { all, inner: cells(3, inner), rest: cells(3, rest) };
    for (const name of Object.keys(FAMILIES)) shown[name] = cells(2, lines[name]);
    return shown;
  };

  const colour = (text) => [1, 3, 5].map((k) => parseInt(text.slice(k, k + 2), 16) / 255);

  // The parallelogram of the two ratios: its sides run along d1 and d2, its diagonals along u, v
  const parallelogram = ({ lam, theta }) => {
    const turn = (theta * Math.PI) / 180;
    const a = [1, 0];
    const b = [lam * Math.cos(turn), lam * Math.sin(turn)];
    const corners = [
      [-(a[0] + b[0]) / 2, -b[1] / 2],
      [(a[0] - b[0]) / 2, -b[1] / 2],
      [(a[0] + b[0]) / 2, b[1] / 2],
      [(b[0] - a[0]) / 2, b[1] / 2],
    ];
    const size = Math.max(...corners.map(([x, y]) => Math.hypot(x, y)));
    return corners.map(([x, y]) => [(70 * x) / size, (-70 * y) / size]);
  };

  const TEMPLATE = `
    <div class="scene-view" :aria-label="scene.words" role="img">
      <vtk-view ref="view" :background="paper" :interactor-settings="buttons"
          @reset-camera="aim">
        <vtk-geometry-representation v-for="layer in layers" :key="layer.name"
            :property="layer.property" :actor="layer.actor" :mapper="layer.mapper">
          <vtk-polydata :key="layer.name + version" :points="shown.all" v-bind="layer.cells"/>
        </vtk-geometry-representation>
      </vtk-view>
    </div>
    <div class="scene-side">
      <svg viewBox="-90 -84 180 168" class="scene-parallelogram" role="img"
          :aria-label="'parallelogram, theta ' + state.theta + ', theta0 ' + state.theta0">
        <polygon :points="corners.join(' ')" :fill="scene.colours.inner"/>
        <line v-for="side in sides" v-bind="side"/>
        <path :d="arcs[0].path" class="arc"/><path :d="arcs[1].path" class="arc"/>
        <text v-for="arc in arcs" :x="arc.x" :y="arc.y">{{ arc.text }}</text>
      </svg>
      <label v-if="scene.states.length > 1" class="scene-slider">
        <span>{{ scene.parameter }}: <b>{{ state.label }}</b></span>
        <input type="range" min="0" :max="scene.states.length - 1" v-model.number="at">
      </label>
      <table class="scene-numbers">
        <tr v-for="(value, name) in numbers"><th>{{ name }}</th><td>{{ value }}</td></tr>
      </table>
      <div class="scene-families">
        <label v-for="(title, name) in titles">
          <input type="checkbox" v-model="on[name]">
          <i :style="{ background: scene.colours[name] }"></i>{{ title }}
        </label>
        <button type="button" @click="aim">front view</button>
      </div>
    </div>`;

  const app = (scene) => ({
    template: TEMPLATE,
    data() {
      return {
        scene: Vue.markRaw(scene),
        at: scene.first,
        paper: [1, 1, 1],
        version: 0,
        on: { inner: true, u: true, v: true, d1: false, d2: false, ...scene.on },
        titles: {
          inner: "parallelograms", u: "u-curves", v: "v-curves", d1: "diagonals d1", d2: "diagonals d2",
        },
        buttons: [
          { button: 1, action: "Rotate" },
          { button: 2, action: "Pan" },
          { button: 3, action: "Zoom" },
          { button: 1, action: "Pan", shift: true },
        ],
      };
    },
    computed: {
      state() { return this.scene.states[this.at]; },
      shown() {
        const Q = this.state.Q ?? this.scene.Q;
        return Vue.markRaw(build(points(this.state.V), new Uint16Array(bytes(Q))));
      },
      corners() { return parallelogram(this.state); },
      sides() {
        const { colours } = this.scene;
        const [a, b, c, d] = this.corners;
        const ends = [[a, b, "d1"], [d, c, "d1"], [b, c, "d2"], [a, d, "d2"], [a, c, "u"], [b, d, "v"]];
        return ends.map(([p, q, name]) => (
          { x1: p[0], y1: p[1], x2: q[0], y2: q[1], stroke: colours[name] }
        ));
      },
      arcs() {
        const [a, b, c, d] = this.corners;
        const one = (apex, p, q, radius, text) => {
          const to = [p, q].map(([x, y]) => Math.atan2(y - apex[1], x - apex[0]));
          const at = (turn, r) => [apex[0] + r * Math.cos(turn), apex[1] + r * Math.sin(turn)];
          let [s, t] = to;
          if (t > s) t -= 2 * Math.PI;
          const middle = at((s + t) / 2, radius + 15);
          const path = `M ${at(s, radius)} A ${radius} ${radius} 0 0 0 ${at(t, radius)}`;
          return { path, x: middle[0], y: middle[1] + 4, text };
        };
        return [
          one(a, b, d, 16, `${this.state.theta.toFixed(0)}\u00b0`),
          one([0, 0], c, d, 12, `${this.state.theta0.toFixed(0)}\u00b0`),
        ];
      },
      numbers() {
        const { theta, theta0, lam, mu, off, faces, flips, darts } = this.state;
        return {
          "\u03b8": `${theta.toFixed(2)}\u00b0`,
          "\u03b8\u2080": `${theta0.toFixed(2)}\u00b0`,
          "\u03bb": lam.toFixed(4),
          "\u03bc": mu.toFixed(4),
          "largest deviation": `${off.toFixed(3)}\u00b0`,
          "quads, flipped, darts": `${faces}, ${flips}, ${darts}`,
        };
      },
      layers() {
        const { colours } = this.scene;
        const { shown, on } = this;
        const back = { resolveCoincidentTopology: 1 };
        const face = (name, fill) => ({
          name, mapper: back, actor: { visibility: true }, cells: { polys: shown[name] },
          property: { color: colour(fill), interpolation: 0, ambient: 0.35, diffuse: 0.7, specular: 0.05 },
        });
        const line = (name) => ({
          name, mapper: {}, actor: { visibility: on[name] }, cells: { lines: shown[name] },
          property: { color: colour(colours[name]), lineWidth: 2, lighting: false },
        });
        return [
          face("inner", on.inner ? colours.inner : colours.rest),
          face("rest", colours.rest),
          ...Object.keys(FAMILIES).map(line),
        ];
      },
    },
    watch: { at() { this.version += 1; } },
    methods: {
      aim() { this.$refs.view?.setCamera(this.scene.camera); },
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

  const mount = async (element) => {
    const name = element.dataset.scene;
    await load("vue.global.js");
    await Promise.all([load("trame-vtk.js"), load(`scenes/${name}.js`)]);
    const made = Vue.createApp(app(scenes[name]));
    made.use(vue_vtk);
    element.inet = made.mount(element);
  };
  const start = () => {
    const near = new IntersectionObserver((found) => {
      for (const { isIntersecting, target } of found) {
        if (isIntersecting) {
          near.unobserve(target);
          mount(target);
        }
      }
    }, { rootMargin: "300px" });
    document.querySelectorAll(".scene").forEach((element) => near.observe(element));
  };
  if (document.readyState === "loading") document.addEventListener("DOMContentLoaded", start);
  else start();
})();
