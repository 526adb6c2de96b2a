"use strict";
// Steps over samples that are in the page; what it computes is where to draw them.
const data = JSON.parse(document.getElementById("data").textContent);
const slider = document.getElementById("sample");
const place = document.querySelector("output[for=sample]");
const LABEL = 34; // distance of a number from its shaft
const BAR = 22; // half the length of the bar that is a bearing
const SVG = "http://www.w3.org/2000/svg";

const shown = (value, decimals) => value.toFixed(decimals).replace("-", "\u2212");

const curves = data.curves.map((curve, number) => {
  const line = document.getElementById(`curve-${number}`);
  return {
    ...curve,
    points: line.points,
    dot: line.nextElementSibling,
    cursor: line.ownerSVGElement.querySelector(".cursor"),
    output: document.querySelector(`output[data-curve="${number}"]`),
  };
});

function point(curve, sample) {
  const { x, y } = curve.points.getItem(sample);
  curve.output.textContent = shown(curve.values[sample], curve.decimals);
  curve.dot.setAttribute("cx", x);
  curve.dot.setAttribute("cy", y);
  curve.cursor.setAttribute("x1", x);
  curve.cursor.setAttribute("x2", x);
}

const plus = (p, q, factor) => p.map((value, i) => value + factor * q[i]);
const dot = (p, q) => p[0] * q[0] + p[1] * q[1] + p[2] * q[2];

function added(parent, name, attributes, text = "") {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.textContent = text;
  return parent.appendChild(element);
}

// Returns what draws one view at a sample. Of yokes and crosses the half away from the viewer is faint.
function drawn(view, svg) {
  const { points: allPoints, pins, bearings, pin, yoke } = data.drawing;
  const flat = (p) => [0, 1].map((i) => view.offset[i] + dot(view.axes[i], p));
  const at = (p) => flat(p).map((value) => value.toFixed(1)).join(" ");
  const shafts = allPoints[0].slice(1).map(() => added(svg, "path", { class: "shaft" }));
  const halves = pins[0].map(() =>
    ["in", "out"].map((side) =>
      [1, -1].map((sign) => ({
        sign,
        yoke: added(svg, "path", { class: `yoke ${side}` }),
        arm: added(svg, "path", { class: "arm" }),
        // One end of each pin is marked: a cross turned by half a turn looks the same.
        mark: sign > 0 ? added(svg, "circle", { class: `mark ${side}`, r: 8 }) : null,
      })),
    ),
  );
  const bars = bearings.map((_, i) => ({
    path: added(svg, "path", { class: "bearing" }),
    name: added(svg, "text", {}, `B${i}`),
  }));
  // Beyond the tips of a yoke that is near.
  const away = Math.max(BAR, pin * Math.hypot(...view.axes[0])) + 0.75 * LABEL;
  const labels = shafts.map((_, i) => added(svg, "text", {}, i));
  return (sample) => {
    const points = allPoints[Math.min(sample, allPoints.length - 1)];
    const along = shafts.map((_, i) => {
      const way = plus(points[i + 1], points[i], -1);
      const length = Math.sqrt(dot(way, way));
      return way.map((value) => value / length);
    });
    shafts.forEach((path, i) => {
      const from = plus(points[i], along[i], i === 0 ? 0 : yoke);
      const to = plus(points[i + 1], along[i], i === shafts.length - 1 ? 0 : -yoke);
      path.setAttribute("d", `M${at(from)}L${at(to)}`);
      const [[x, y], [right, down]] = [flat(from), flat(to)];
      const length = Math.hypot(right - x, down - y) || 1;
      labels[i].setAttribute("x", (x + right) / 2 + (LABEL * (down - y)) / length);
      labels[i].setAttribute("y", (y + down) / 2 - (LABEL * (right - x)) / length);
    });
    bars.forEach(({ path, name }, i) => {
      const [shaft, share] = bearings[i];
      const way = plus(points[shaft + 1], points[shaft], -1);
      const [x, y] = flat(plus(points[shaft], way, share));
      const [right, down] = [0, 1].map((k) => dot(view.axes[k], way));
      const length = Math.hypot(right, down) || 1;
      const aside = [-down / length, right / length];
      const end = (size) => [x + size * aside[0], y + size * aside[1]].map((value) => value.toFixed(1)).join(" ");
      path.setAttribute("d", `M${end(-BAR)}L${end(BAR)}`);
      name.setAttribute("x", x + away * aside[0]);
      name.setAttribute("y", y + away * aside[1]);
    });
    halves.forEach((sides, joint) =>
      sides.forEach((signs, side) =>
        signs.forEach(({ sign, yoke: bow, arm, mark }) => {
          const centre = points[joint + 1];
          const back = plus(centre, along[joint + side], side === 0 ? -yoke : yoke);
          const across = pins[sample][joint][side].map((value) => sign * pin * value);
          const end = plus(centre, across, 1);
          bow.setAttribute("d", `M${at(back)}L${at(plus(back, across, 1))}L${at(end)}`);
          arm.setAttribute("d", `M${at(centre)}L${at(end)}`);
          if (mark) {
            const [x, y] = flat(end);
            mark.setAttribute("cx", x);
            mark.setAttribute("cy", y);
          }
          for (const part of [bow, arm, mark]) {
            part?.classList.toggle("far", dot(view.axes[2], across) < 0);
          }
        }),
      ),
    );
  };
}

const views = data.drawing.views.map((view, number) => drawn(view, document.getElementById(`view-${number}`)));

function show() {
  const sample = slider.valueAsNumber;
  place.textContent = data.places[sample];
  slider.setAttribute("aria-valuetext", data.places[sample]);
  curves.forEach((curve) => point(curve, sample));
  views.forEach((draw) => draw(sample));
}

slider.addEventListener("input", show);
show();
