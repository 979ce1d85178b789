// Two windows where A and B differ most in their error, enlarged beside each other; they can be moved.
function chooseInsets(view) {
  const {a, b, reference} = view.images, {width, height} = view.size;
  const side = Math.max(4, Math.min(Math.round(Math.min(width, height) / 6), 64));
  if (side > Math.min(width, height) || (a === b && !reference)) return [];
  let score;
  if (reference && a && b) {
    const errorA = relativeError(a, reference), errorB = relativeError(b, reference);
    score = a === b ? errorA : errorA.map((v, p) => Math.abs(v - errorB[p]));
  } else {
    score = Float32Array.from({length: width * height}, (_, p) => Math.abs(luminanceAt(a.values, p) - luminanceAt(b.values, p)));
  }
  const first = bestWindow(score, width, height, side);
  return [first, bestWindow(score, width, height, side, [first])].map(({x, y}) => ({x, y, width: side, height: side}));
}

function moveInset(view, index, x, y) {
  const inset = view.state.insets[index], {width, height} = view.size;
  inset.x = Math.max(0, Math.min(width - inset.width, Math.round(x)));
  inset.y = Math.max(0, Math.min(height - inset.height, Math.round(y)));
}

// Index of the inset that holds a pixel, -1 for none.
const insetAt = (view, pixel) => view.state.insets.findIndex((i) => pixel.x >= i.x && pixel.y >= i.y &&
  pixel.x < i.x + i.width && pixel.y < i.y + i.height);

function drawInsets(view) {
  const holder = view.insets, {insets} = view.state;
  const room = view.area.clientWidth / view.faces.length;  // of one picture, the insets in one row
  const across = report.all ? Math.max(1, Math.min(insets.length, Math.floor(room / 102))) : insets.length;
  const side = Math.max(60, Math.min(180, Math.floor(room / across) - 12));
  holder.replaceChildren(...insets.map((inset, i) => {
    const strip = element('div', {class: 'inset', role: 'group', tabindex: '0',
      'aria-label': `Inset ${i + 1}: arrow keys move it`, style: `--inset: ${insetColour(i)}`});
    const enlarged = side / Math.max(inset.width, inset.height), [w, h] = [inset.width, inset.height].map((n) => Math.ceil(n * enlarged));
    strip.addEventListener('keydown', (event) => {
      const step = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]}[event.key];
      if (!step) return;
      event.preventDefault();
      moveInset(view, i, inset.x + step[0], inset.y + step[1]);
      render(view);
      view.insets.children[i].focus();
    });
    for (const face of view.faces) {
      const canvas = canvasOf(w, h), context = canvas.getContext('2d'), source = facePainting(view, face);
      context.imageSmoothingEnabled = false;
      if (source) context.drawImage(source, inset.x, inset.y, inset.width, inset.height, 0, 0, w, h);
      named(canvas, `${face.name}, inset ${i + 1}`);
      strip.append(element('figure', {style: `width: ${Math.max(60, w)}px`}, canvas, element('figcaption', {title: face.name}, face.name)));
    }
    return strip;
  }));
}
