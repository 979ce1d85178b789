// Mouse and fingers on the panes: drag moves the picture, an inset or the split; two fingers and the wheel zoom.
function listenToPointers(view) {
  const {stage, state} = view, held = new Map();
  let dragged = null, moved = false, apart = 0;
  const canvasOfEvent = (event) => (event.target instanceof HTMLCanvasElement ? event.target : null);
  const spread = () => {
    const [a, b] = [...held.values()];
    return Math.hypot(a.x - b.x, a.y - b.y);
  };
  stage.addEventListener('pointerdown', (event) => {
    const canvas = canvasOfEvent(event);
    if (!canvas || !view.faces) return;
    stage.focus({preventScroll: true});
    canvas.setPointerCapture(event.pointerId);
    held.set(event.pointerId, {x: event.clientX, y: event.clientY});
    moved = false;
    if (held.size === 2) apart = spread();
    const pixel = pixelAt(view, canvas, event.clientX, event.clientY), box = canvas.getBoundingClientRect();
    const inset = pixel ? insetAt(view, pixel) : -1;
    const onEdge = state.mode === 'split' && Math.abs(event.clientX - box.left - state.split * box.width) < 14;
    dragged = onEdge ? {split: true} : inset >= 0 ? {inset, dx: pixel.x - state.insets[inset].x, dy: pixel.y - state.insets[inset].y} : {};
  });
  stage.addEventListener('pointermove', (event) => {
    const canvas = canvasOfEvent(event);
    if (!canvas || !view.faces) return;
    const last = held.get(event.pointerId);
    if (last) {
      const x = event.clientX - last.x, y = event.clientY - last.y;
      if (Math.hypot(x, y) < 3 && !moved) return;
      moved = true;
      held.set(event.pointerId, {x: event.clientX, y: event.clientY});
      drag(canvas, event, x, y);
    } else {
      state.cursor = pixelAt(view, canvas, event.clientX, event.clientY);
      drawPanes(view);
      showValues(view);
    }
  });
  function drag(canvas, event, x, y) {
    if (held.size === 2) {
      const now = spread();
      zoomBy(view, now / apart);
      apart = now;
      return;
    }
    const box = canvas.getBoundingClientRect();
    if (dragged?.split) {
      state.split = Math.max(0, Math.min(1, (event.clientX - box.left) / box.width));
      render(view);
    } else if (dragged?.inset >= 0) {
      const pixel = pixelAt(view, canvas, event.clientX, event.clientY);
      if (!pixel) return;
      moveInset(view, dragged.inset, pixel.x - dragged.dx, pixel.y - dragged.dy);
      drawPanes(view);
      drawInsets(view);
    } else {
      state.x -= x / box.width / state.zoom;
      state.y -= y / box.height / state.zoom;
      drawPanes(view);
    }
  }
  const release = (event) => {
    const canvas = canvasOfEvent(event);
    if (event.type === 'pointerup' && canvas && held.has(event.pointerId) && !moved && held.size === 1) {
      state.pixel = pixelAt(view, canvas, event.clientX, event.clientY);
      render(view);
    }
    held.delete(event.pointerId);
    dragged = null;
  };
  for (const name of ['pointerup', 'pointercancel']) stage.addEventListener(name, release);
  stage.addEventListener('pointerleave', () => {
    state.cursor = null;
    if (view.faces) { drawPanes(view); showValues(view); }
  });
  // The page scrolls over the pictures until they were clicked into.
  stage.addEventListener('wheel', (event) => {
    const canvas = canvasOfEvent(event);
    if (!canvas || !view.faces || (!event.ctrlKey && document.activeElement !== stage)) return;
    event.preventDefault();
    const before = pixelAt(view, canvas, event.clientX, event.clientY);
    zoomBy(view, event.deltaY < 0 ? 1.2 : 1 / 1.2);
    const after = pixelAt(view, canvas, event.clientX, event.clientY);
    if (before && after) {
      state.x += (before.x - after.x) / view.size.width;
      state.y += (before.y - after.y) / view.size.height;
      drawPanes(view);
    }
  }, {passive: false});
}

// The values of every pane under the cursor, or of the pixel that was touched.
function showValues(view) {
  const {cursor, pixel} = view.state, at = cursor ?? pixel;
  if (!at) {
    view.status.textContent = 'Point at a pixel for its values.';
    return;
  }
  const crop = view.scene().crop ?? [0, 0], p = at.y * view.size.width + at.x;
  const texts = view.faces.map(({letter, picture}) => {
    if (!picture) return `${letter} -`;
    const {channels, values} = picture;
    const numbers = channels === 3 ? [0, 1, 2].map((c) => values[3 * p + c]) : [values[p]];
    return `${letter} ${numbers.map((v) => (Number.isNaN(v) ? 'none' : numberText(v, 3))).join(' ')}`;
  });
  const whole = report.shrunk ?? 1;
  view.status.textContent = `x ${at.x * whole + crop[0]}, y ${at.y * whole + crop[1]}:  ${texts.join('   ')}`;
}
