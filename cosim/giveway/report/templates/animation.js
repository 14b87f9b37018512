"use strict";
// Top view of one run per bumper, side by side, all at the same time since contact, or since the first push.
(() => {
  const scenes = JSON.parse(document.getElementById("scenes").textContent);
  const canvas = document.getElementById("stage"), pen = canvas.getContext("2d");
  const seek = document.getElementById("seek"), clock = document.getElementById("clock");
  const play = document.getElementById("play"), speed = document.getElementById("speed");
  const colours = { truth: "#7a2ea0", estimate: "#0b64a8", detected: "#c8500a", body: "#eef1f4", ink: "#2b2f36" };
  const metresPerNewton = 0.004, smallestForce = 2, longestArrow = 0.45, railLength = 2;
  const first = Math.min(...scenes.map(s => s.time[0]));
  const last = Math.max(...scenes.map(s => s.time[s.time.length - 1]));
  let now = first, playing = false, before = 0;

  // The slider is slow where the impact is: half of it covers the first 0.6 s.
  const knee = Math.min(0.6, last), half = 500;
  const toTime = v => v < half ? first + (knee - first) * v / half : knee + (last - knee) * (v - half) / half;
  const toSlider = t => t < knee ? half * (t - first) / (knee - first) : half + half * (t - knee) / Math.max(last - knee, 1e-9);

  // From (distance behind the tip of the nose, distance to the left of the rail) to the world.
  function place(obstacle, nose) {
    const [x, y] = obstacle.rail;
    return ([back, left]) => [nose[0] - x * back - y * left, nose[1] - y * back + x * left];
  }

  // All that moves must stay in view: limits over every scene, the same scale for all.
  function limits(s) {
    const box = [Infinity, Infinity, -Infinity, -Infinity], reach = s.wheel.distance + s.wheel.radius;
    const add = (x, y, r) => {
      box[0] = Math.min(box[0], x - r); box[1] = Math.min(box[1], y - r);
      box[2] = Math.max(box[2], x + r); box[3] = Math.max(box[3], y + r);
    };
    s.base[0].forEach((x, i) => add(x, s.base[1][i], reach));
    if (s.obstacle) s.time.forEach((_, i) => {
      const at = place(s.obstacle, [s.nose[0][i], s.nose[1][i]]);
      [...s.obstacle.body, ...(s.obstacle.edge || [[0, 0]])].forEach(p => add(...at(p), 0.02));
    });
    return box;
  }
  const boxes = scenes.map(limits);
  const box = boxes[0].map((_, k) => (k < 2 ? Math.min : Math.max)(...boxes.map(b => b[k])));

  function sample(s, t) {
    let low = 0, high = s.time.length - 1;
    if (t >= s.time[high]) low = high;
    while (high - low > 1) { const mid = (low + high) >> 1; if (s.time[mid] <= t) low = mid; else high = mid; }
    const next = Math.min(low + 1, s.time.length - 1), span = s.time[next] - s.time[low];
    const share = span > 0 ? Math.max(0, Math.min(1, (t - s.time[low]) / span)) : 0;
    const mix = a => a[low] + (a[next] - a[low]) * share;
    return { mix, pair: p => [mix(p[0]), mix(p[1])] };
  }

  function arrow(tip, force, colour, width, scale) {
    const size = Math.hypot(...force);
    if (size < smallestForce) return;
    const length = Math.min(size * metresPerNewton, longestArrow), u = [force[0] / size, force[1] / size];
    const head = 9 / scale, tail = [tip[0] - u[0] * (length + head), tip[1] - u[1] * (length + head)];
    const neck = [tip[0] - u[0] * head, tip[1] - u[1] * head];
    pen.strokeStyle = pen.fillStyle = colour; pen.lineWidth = width / scale;
    pen.beginPath(); pen.moveTo(...tail); pen.lineTo(...neck); pen.stroke();
    pen.beginPath(); pen.moveTo(...tip);
    pen.lineTo(neck[0] - u[1] * head * .5, neck[1] + u[0] * head * .5);
    pen.lineTo(neck[0] + u[1] * head * .5, neck[1] - u[0] * head * .5); pen.fill();
  }
  function dot(at, colour, radius, scale) {
    pen.fillStyle = colour; pen.beginPath(); pen.arc(at[0], at[1], radius / scale, 0, 7); pen.fill();
  }
  function ring(at, colour, radius, scale) {
    pen.strokeStyle = colour; pen.lineWidth = 2 / scale;
    pen.beginPath(); pen.arc(at[0], at[1], radius / scale, 0, 7); pen.stroke();
  }
  const polygon = corners => {
    pen.beginPath(); corners.forEach((c, i) => i ? pen.lineTo(...c) : pen.moveTo(...c)); pen.closePath();
  };

  function grid(scale) {
    pen.strokeStyle = "#e9ecf0"; pen.lineWidth = 1 / scale;
    for (let x = Math.ceil((box[0] - 1) * 4) / 4; x < box[2] + 1; x += 0.25) {
      pen.beginPath(); pen.moveTo(x, box[1] - 1); pen.lineTo(x, box[3] + 1); pen.stroke();
    }
    for (let y = Math.ceil((box[1] - 1) * 4) / 4; y < box[3] + 1; y += 0.25) {
      pen.beginPath(); pen.moveTo(box[0] - 1, y); pen.lineTo(box[2] + 1, y); pen.stroke();
    }
  }
  function robot(s, pose, compression, scale) {
    pen.save(); pen.translate(pose[0], pose[1]); pen.rotate(pose[2]);
    for (let wheel = 0; wheel < 3; wheel++) {
      pen.save(); pen.rotate(wheel * 2 * Math.PI / 3); pen.translate(s.wheel.distance, 0);
      pen.fillStyle = "#aab1bb"; pen.fillRect(-s.wheel.width / 2, -s.wheel.radius, s.wheel.width, 2 * s.wheel.radius);
      pen.restore();
    }
    polygon(s.outline); pen.fillStyle = "rgba(238,241,244,.85)"; pen.fill();
    pen.strokeStyle = colours.ink; pen.lineWidth = 1.6 / scale; pen.stroke();
    if (s.plate) bumperOnRobot(s.plate, compression, scale);
    pen.fillStyle = colours.ink; polygon([[0.07, 0], [-0.02, 0.03], [-0.02, -0.03]]); pen.fill();
    pen.restore();
  }
  // A zigzag between two points, or a bar if it does not give.
  function spring(from, to, gives, scale) {
    const length = Math.max(Math.hypot(to[0] - from[0], to[1] - from[1]), 1e-9);
    const across = [-(to[1] - from[1]) / length, (to[0] - from[0]) / length];
    pen.strokeStyle = "#8a8f98"; pen.lineWidth = (gives ? 1.4 : 6) / scale; pen.beginPath();
    for (let k = 0; k <= 10; k++) {
      const side = !gives || k % 10 === 0 ? 0 : k % 2 ? 0.022 : -0.022;
      const at = [0, 1].map(i => from[i] + (to[i] - from[i]) * k / 10 + across[i] * side);
      (k ? pen.lineTo : pen.moveTo).apply(pen, at);
    }
    pen.stroke();
  }
  function slider(obstacle, nose, compression, scale) {
    const at = place(obstacle, nose), moved = obstacle.sprung ? compression : 0;
    const body = obstacle.body.map(([back, left]) => [back - moved, left]);
    pen.strokeStyle = "#c9ced6"; pen.lineWidth = 3 / scale;
    pen.beginPath(); pen.moveTo(...at([body[1][0], 0])); pen.lineTo(...at([railLength, 0])); pen.stroke();
    spring(at([obstacle.front, 0]), at([body[0][0], 0]), obstacle.sprung, scale);
    polygon(body.map(at));
    pen.fillStyle = "#d5dae1"; pen.fill(); pen.strokeStyle = colours.ink; pen.lineWidth = 1.2 / scale; pen.stroke();
    pen.fillStyle = "#4a505a";
    if (obstacle.edge) { polygon(obstacle.edge.map(at)); pen.fill(); return; }
    pen.beginPath(); pen.arc(...at([obstacle.radius, 0]), obstacle.radius, 0, 7); pen.fill();
  }
  // In the base frame.
  function bumperOnRobot(plate, compression, scale) {
    const ends = plate.ends.map(e => [0, 1].map(i => e[i] + plate.inward[i] * compression));
    spring(plate.foot, [0, 1].map(i => (ends[0][i] + ends[1][i]) / 2), true, scale);
    pen.strokeStyle = "#4a505a"; pen.lineWidth = 4 / scale;
    pen.beginPath(); pen.moveTo(...ends[0]); pen.lineTo(...ends[1]); pen.stroke();
  }

  function draw() {
    const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
    canvas.width = width * ratio; canvas.height = height * ratio;
    pen.setTransform(ratio, 0, 0, ratio, 0, 0); pen.clearRect(0, 0, width, height);
    const cell = width / scenes.length, top = 52;
    const scale = Math.min((cell - 16) / (box[2] - box[0]), (height - top - 10) / (box[3] - box[1]));
    scenes.forEach((s, index) => {
      const { mix, pair } = sample(s, now), pose = s.base.map(mix), touch = s.touches.filter(t => now >= t.time).pop();
      const hit = touch && touch.detection, felt = hit && now >= hit.time;
      pen.save(); pen.beginPath(); pen.rect(index * cell, 0, cell, height); pen.clip();
      pen.save();
      pen.translate((index + .5) * cell, top + (height - top - 10) / 2); pen.scale(scale, -scale);
      pen.translate(-(box[0] + box[2]) / 2, -(box[1] + box[3]) / 2);
      grid(scale); if (s.obstacle) slider(s.obstacle, pair(s.nose), mix(s.compression), scale);
      robot(s, pose, mix(s.compression), scale);
      const force = pair(s.force), touching = Math.hypot(...force) >= smallestForce;
      if (touching) { arrow(pair(s.point), force, colours.truth, 5, scale); dot(pair(s.point), colours.truth, 5, scale); }
      if (felt) {
        const [c, d] = [Math.cos(pose[2]), Math.sin(pose[2])], turn = v => [c * v[0] - d * v[1], d * v[0] + c * v[1]];
        const p = turn(hit.point), at = [p[0] + pose[0], p[1] + pose[1]];
        arrow(at, turn(hit.force), colours.detected, 2.5, scale); ring(at, colours.detected, 6, scale);
      } else if (touch && Math.hypot(...pair(s.estimated_force)) >= smallestForce) {
        arrow(pair(s.estimated_point), pair(s.estimated_force), colours.estimate, 2.5, scale);
        ring(pair(s.estimated_point), colours.estimate, 6, scale);
      }
      pen.restore();
      pen.fillStyle = colours.ink; pen.font = "600 14px system-ui, sans-serif"; pen.fillText(s.label, index * cell + 14, 24);
      pen.font = "13px system-ui, sans-serif"; pen.fillStyle = felt ? colours.detected : "#5a616c";
      const newtons = `${touch ? touch.what : ""}: ${Math.hypot(...force).toFixed(0)} N`;
      pen.fillText(!touch ? (s.touches.length ? `before the ${s.touches[0].what}` : "nothing touches the robot") :
        felt ? `${touch.what} detected after ${((hit.time - touch.time) * 1000).toFixed(0)} ms` :
        hit || touching ? newtons : `${touch.what} not detected`,
        index * cell + 14, 42);
      if (index) { pen.strokeStyle = "#e1e4e8"; pen.lineWidth = 1; pen.beginPath(); pen.moveTo(index * cell, 0); pen.lineTo(index * cell, height); pen.stroke(); }
      pen.restore();
    });
    const right = width - 14, metre = 0.25 * scale;
    pen.strokeStyle = pen.fillStyle = "#5a616c"; pen.lineWidth = 2;
    pen.beginPath(); pen.moveTo(right - metre, height - 14); pen.lineTo(right, height - 14); pen.stroke();
    pen.font = "12px system-ui, sans-serif"; pen.textAlign = "right"; pen.fillText("0.25 m", right, height - 20); pen.textAlign = "left";
    clock.textContent = Math.abs(now) < 1 ? `${(now * 1000).toFixed(0)} ms` : `${now.toFixed(2)} s`;
    seek.value = toSlider(now);
  }

  function frame(stamp) {
    if (!playing) return;
    now += (stamp - before) / 1000 * Number(speed.value); before = stamp;
    if (now >= last) { now = last; setPlaying(false); }
    draw(); requestAnimationFrame(frame);
  }
  function setPlaying(wanted) {
    playing = wanted; play.textContent = playing ? "Pause" : "Play";
    if (playing) { if (now >= last) now = first; before = performance.now(); requestAnimationFrame(frame); }
  }
  play.addEventListener("click", () => setPlaying(!playing));
  seek.addEventListener("input", () => { setPlaying(false); now = toTime(Number(seek.value)); draw(); });
  window.addEventListener("resize", draw);
  const shown = scenes.map(s => s.touches.map(t => t.detection).find(Boolean)).filter(Boolean).map(d => d.time);
  now = shown.length ? Math.max(...shown) + 0.01 : first;  // open on something worth seeing
  draw();
})();
