// The panes of the viewer: their size, what is drawn in them, which pixel lies where.
const insetColours = ['#ffd400', '#00e5ff', '#ff5cc8', '#7dff5c', '#ff8a3d', '#b18cff'];
const insetColour = (i) => insetColours[i % insetColours.length];
const LEAST_PANE = 220;  // CSS pixels, where there are several rows

// As large as the width and most of the window's height allow, with the picture's own shape: it fills its pane.
function paneSize(view, count) {
  const whole = view.area.clientWidth - (report.all ? 1 : 0), {width, height} = view.size;
  const most = report.all ? Math.max(1, Math.floor((whole + 8) / (LEAST_PANE + 8))) : count;
  const columns = Math.ceil(count / Math.ceil(count / most));
  const wide = Math.max(80, Math.min((whole - 8 * (columns - 1)) / columns, 0.8 * innerHeight * width / height));
  return {width: Math.floor(wide), height: Math.floor(wide * height / width)};
}

// What each pane shows: one face, or two on both sides of the slider.
function paneFaces(view) {
  const {mode, face} = view.state;
  if (mode === 'side') return view.faces.map((f) => [f]);
  const [a, b] = report.all ? [view.state.a, view.state.b] : [0, 1];
  return mode === 'split' ? [[view.faces[a], view.faces[b]]] : [[view.faces[face]]];
}

function layOutPanes(view) {
  const faces = paneFaces(view), size = paneSize(view, faces.length);
  while (view.panes.length > faces.length) view.panes.pop().node.remove();
  while (view.panes.length < faces.length) {
    const canvas = element('canvas', {}), caption = element('figcaption');
    const node = element('figure', {class: 'pane'}, caption, canvas);
    view.stage.append(node);
    view.panes.push({node, canvas, caption});
  }
  const unit = devicePixelRatio || 1;
  view.panes.forEach((pane, i) => {
    pane.faces = faces[i];
    pane.caption.textContent = faces[i].map((f) => (f.letter === 'R' ? f.name : `${f.letter}: ${f.name}`)).join('  |  ');
    pane.caption.title = pane.caption.textContent;
    named(pane.canvas, `${pane.caption.textContent}: ${layers[view.state.layer].name}`);
    pane.node.style.width = `${size.width}px`;
    Object.assign(pane.canvas.style, {width: `${size.width}px`, height: `${size.height}px`});
    if (pane.canvas.width !== Math.round(size.width * unit) || pane.canvas.height !== Math.round(size.height * unit)) {
      pane.canvas.width = Math.round(size.width * unit);
      pane.canvas.height = Math.round(size.height * unit);
    }
  });
  view.paneSize = size;
}

// Device pixels per pixel of the picture, and the picture's place in the pane; the picture always covers the pane.
function geometry(view, canvas) {
  const {state, size} = view, scale = canvas.width / size.width * state.zoom;
  const clamp = (centre, side, whole) => {
    const half = side / scale / whole / 2;
    return half >= 0.5 ? 0.5 : Math.max(half, Math.min(1 - half, centre));
  };
  state.x = clamp(state.x, canvas.width, size.width);
  state.y = clamp(state.y, canvas.height, size.height);
  return {scale, left: canvas.width / 2 - state.x * size.width * scale, top: canvas.height / 2 - state.y * size.height * scale};
}

function drawPanes(view) {
  const unit = devicePixelRatio || 1, {state} = view;
  for (const {canvas, faces} of view.panes) {
    const context = canvas.getContext('2d'), at = geometry(view, canvas);
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, canvas.width, canvas.height);
    const edge = faces.length === 2 ? Math.round(state.split * canvas.width) : canvas.width;
    faces.forEach((face, i) => {
      context.save();
      context.beginPath();
      context.rect(i === 0 ? 0 : edge, 0, i === 0 ? edge : canvas.width - edge, canvas.height);
      context.clip();
      drawFace(view, context, face, at);
      context.restore();
    });
    if (faces.length === 2) {
      context.fillStyle = '#fff';
      context.fillRect(edge - unit, 0, 2 * unit, canvas.height);
    }
    drawMarks(view, context, at, unit);
    const map = faces.find((face) => face.map && face.picture);
    if (map) {
      drawBar(context, layers[state.layer].scale(view.scene(), view.budgets()[state.budget]), canvas.width, canvas.height, unit);
    }
  }
}

function drawFace(view, context, face, {scale, left, top}) {
  const source = facePainting(view, face);
  if (!source) {
    context.fillStyle = pageColour('--text-colour');
    context.font = '14px system-ui, sans-serif';
    context.fillText(`${face.name}: no ${layers[view.state.layer].name} map`, 10, 24);
    return;
  }
  context.imageSmoothingEnabled = scale < 1;
  context.drawImage(source, left, top, view.size.width * scale, view.size.height * scale);
}

// Inset windows, the pixel that was touched and the cursor, in every pane.
function drawMarks(view, context, {scale, left, top}, unit) {
  const frame = ({x, y, width = 1, height = 1}, colour, line) => {
    context.strokeStyle = colour;
    context.lineWidth = line * unit;
    context.strokeRect(left + x * scale, top + y * scale, width * scale, height * scale);
  };
  view.state.insets.forEach((inset, i) => {
    frame(inset, '#000', 4);
    frame(inset, insetColour(i), 2);
  });
  const crop = view.scene().crop ?? [0, 0];
  for (const {x, y} of pixelsOf(view.scene().dump)) {
    context.beginPath();
    context.arc(left + (x - crop[0] + 0.5) * scale, top + (y - crop[1] + 0.5) * scale, 4 * unit, 0, 2 * Math.PI);
    context.strokeStyle = '#000';
    context.lineWidth = 3 * unit;
    context.stroke();
    context.strokeStyle = '#fff';
    context.lineWidth = 1.5 * unit;
    context.stroke();
  }
  const {pixel, cursor} = view.state;
  if (pixel) {
    frame(pixel, '#000', 4);
    frame(pixel, '#fff', 2);
  }
  if (cursor) frame(cursor, '#fff', 1);
}

// Pixel of the picture under a point of the window; null beside it.
function pixelAt(view, canvas, clientX, clientY) {
  const box = canvas.getBoundingClientRect(), unit = canvas.width / box.width, at = geometry(view, canvas);
  const x = Math.floor(((clientX - box.left) * unit - at.left) / at.scale);
  const y = Math.floor(((clientY - box.top) * unit - at.top) / at.scale);
  return x >= 0 && y >= 0 && x < view.size.width && y < view.size.height ? {x, y} : null;
}
