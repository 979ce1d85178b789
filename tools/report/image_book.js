// One recording's images in a FlipBook: pages share zoom, pan and exposure. At most one book exists.
function startImages(area) {
  const {scenes, sets} = report.pictures;
  const shownSets = sets.filter((set) => Object.keys(set.images).length > 0);
  const controls = element('div', {class: 'controls'});
  const book = element('div', {id: 'book'});
  const legend = element('ol', {class: 'legend', id: 'book-legend'});
  const links = element('p', {class: 'note'});
  area.append(controls, book, element('p', {class: 'note'},
    'Click the picture, then: 1-9, 0 or arrows turn pages, e / Shift+e exposure, f / Shift+f range of a ' +
    'false-colour page, Ctrl+wheel zooms, drag moves, right button shows values, r resets. Values have ' +
    'eleven bits here; the EXR files have all.'), legend, links);
  if (scenes.length === 0) {
    controls.append('No image fits into this page; its EXR files: ');
    links.append(...sets.slice(0, 200).flatMap((set) => linkList(set, 'results')));
    return;
  }
  const choice = {scene: 0, spp: 0, a: 0, b: Infinity};  // the first against the last
  const close = closer(book);

  const here = (set) => report.combinations[set.combination].dump === scenes[choice.scene].dump;
  const budgets = () => [...new Set(shownSets.filter(here).map(
    (set) => report.combinations[set.combination].spp))].sort((x, y) => x - y);
  const candidates = () => shownSets.filter((set) => here(set) &&
    report.combinations[set.combination].spp === budgets()[choice.spp]);

  function rebuild() {
    choice.spp = Math.min(choice.spp, budgets().length - 1);
    const all = candidates(), names = all.map((set) => methodOf(report.combinations[set.combination]));
    choice.a = Math.min(choice.a, all.length - 1);
    choice.b = Math.min(choice.b, all.length - 1);
    const pick = (name, shift = 0) => (i) => { choice[name] = i + shift; rebuild(); };
    controls.replaceChildren(
      select('Recording', scenes.map((s) => report.dumps[s.dump]), choice.scene, pick('scene')),
      select('Samples per pixel', budgets().map(String), choice.spp, pick('spp')),
      select('A', names, choice.a, pick('a')),
      select('B', ['(reference)', ...names], choice.b + 1, pick('b', -1)));
    const a = all[choice.a], b = choice.b < 0 || choice.b === choice.a ? null : all[choice.b];
    const pages = bookPages(scenes[choice.scene], a, b, budgets()[choice.spp]).slice(0, 12);
    showLegend(legend, pages);
    links.replaceChildren(...linkList(a, 'A'), ...(b ? linkList(b, 'B') : []));
    close();
    mountBook(book, scenes[choice.scene], pages, close);
  }

  // WebGL and unpacking wait until the images come near the screen.
  new IntersectionObserver((entries, observer) => {
    if (!entries.some((entry) => entry.isIntersecting)) return;
    observer.disconnect();
    rebuild();
    darkQuery.addEventListener('change', rebuild);
  }, {rootMargin: '200px'}).observe(area);
}

// FlipBook paints from timers that it never stops; those started by a book end with it.
function closer(book) {
  const close = () => {
    close.serial += 1;
    close.timers.splice(0).forEach(clearInterval);
    book.replaceChildren();
  };
  close.serial = 0;
  close.timers = [];
  return close;
}

async function mountBook(book, scene, pages, close) {
  const serial = close.serial, cache = new Map();
  book.append(element('p', {class: 'note'}, 'Unpacking images ...'));
  const pixels = await Promise.all(pages.map((page) => pagePixels(page, cache)));
  if (serial !== close.serial) return;
  const {width, height} = report.pictures.images[pages.find((page) => page.image !== undefined).image];
  const container = element('div', {id: `book-${serial}`, class: 'flip'});
  // As high as the picture wants to be, with room for the rows of controls.
  const controls = innerWidth < 700 ? 90 : 150;
  book.style.height = `${Math.min(0.85 * innerHeight, book.clientWidth * height / width + controls)}px`;
  book.replaceChildren(container);
  const setTimer = window.setInterval;
  window.setInterval = (...timer) => {
    const id = setTimer(...timer);
    close.timers.push(id);
    return id;
  };
  const ready = new MutationObserver(() => {
    if (container.querySelectorAll('canvas').length < pages.length) return;
    ready.disconnect();
    window.setInterval = setTimer;
    finishBook(container);
  });
  ready.observe(container, {childList: true, subtree: true});
  await flipbook.MakeFlipBook({
    dataUrls: pixels, types: pages.map(() => 'float32array'), names: pages.map((page) => page.name),
    width, height, initialZoom: -1, initialTMO: {activeTMO: 'exposure', exposure: scene.exposure},
    initialTMOOverrides: pages.map((page) => page.mapping && {activeTMO: 'script', script: page.mapping.script,
      min: page.mapping.min, max: page.mapping.max, useLog: false}),
    containerId: container.id, colorTheme: isDark() ? 'dark' : 'light', hideTools: innerWidth < 700,
  });
}

function finishBook(container) {
  // Its positive tab indices would come before everything else on the page.
  container.querySelectorAll('[tabindex]').forEach((node) => { node.tabIndex = 0; });
  const stage = container.querySelector('canvas').parentElement.parentElement;
  stage.setAttribute('role', 'application');
  stage.setAttribute('aria-label', 'Images: digits or arrow keys turn pages');
  dragByTouch(stage);
  container.dataset.ready = 'true';
}

// FlipBook knows the mouse only: one finger drags, two zoom.
function dragByTouch(stage) {
  let last = null, distance = 0;
  const middle = (touches) => [0, 1].map((axis) => [...touches].reduce(
    (sum, t) => sum + (axis ? t.clientY : t.clientX), 0) / touches.length);
  const apart = (touches) => Math.hypot(touches[0].clientX - touches[1].clientX,
    touches[0].clientY - touches[1].clientY);
  const begin = (event) => {
    last = event.touches.length > 0 ? middle(event.touches) : null;
    distance = event.touches.length > 1 ? apart(event.touches) : 0;
  };
  for (const name of ['touchstart', 'touchend', 'touchcancel']) stage.addEventListener(name, begin);
  stage.addEventListener('touchmove', (event) => {
    if (!last) return;
    event.preventDefault();
    const [clientX, clientY] = middle(event.touches);
    const target = event.target;
    target.dispatchEvent(new MouseEvent('mousemove', {bubbles: true, buttons: 1, clientX, clientY,
      movementX: Math.round(clientX - last[0]), movementY: Math.round(clientY - last[1])}));
    last = [clientX, clientY];
    if (event.touches.length < 2 || distance === 0) return;
    const ratio = apart(event.touches) / distance;
    if (ratio < 1.25 && ratio > 0.8) return;
    distance = apart(event.touches);
    target.dispatchEvent(new WheelEvent('wheel', {bubbles: true, cancelable: true, ctrlKey: true,
      deltaY: ratio > 1 ? -1 : 1, clientX, clientY}));
  }, {passive: false});
}

function showLegend(legend, pages) {
  legend.replaceChildren(...pages.map((page) => {
    const item = element('li', {}, element('b', {}, page.name), `: ${page.legend} `);
    if (page.mapping) {
      const [first, ...rest] = page.mapping.ends;
      item.append(element('span', {class: 'scale'}, first, ' ',
        element('span', {class: `bar ${page.mapping.bar}`, 'aria-hidden': 'true'}), ' ', rest.join(' … ')));
    }
    return item;
  }));
}

function linkList(set, letter) {
  const c = report.combinations[set.combination];
  return [`${letter}, ${methodOf(c)}, ${c.spp} spp: `, ...Object.entries(set.links).flatMap(
    ([name, href], i) => [i > 0 ? ', ' : '', element('a', {href}, `${name}.exr`)]), '. '];
}
