// One folder's page: chart, sort, filter, wipe, zoom.
try {
  await settled();
  check('nothing is wider than the window', document.documentElement.scrollWidth <= innerWidth,
    `${document.documentElement.scrollWidth} of ${innerWidth}`);
  check('a verdict', find('#verdict').textContent.includes('light_buffer'), find('#verdict').textContent);

  check('nothing jumps while it loads', window.shifts.length === 0, window.shifts);

  // The verdict in pictures: reference, the method to take, the wrong pixels of the alternative.
  const first = () => seen('.first button');
  const kinds = first().map((button) => button.dataset.kind).join();
  check('pictures of the verdict', kinds === 'visibility,shaded,error', kinds);
  const images = first().map((button) => button.firstElementChild);
  check('are there', await until(() => images.every((image) => image.complete && image.naturalWidth > 0)));
  check('with words for those who do not see them', images.every((image) => image.alt.length > 20), images.map((image) => image.alt));
  const captions = seen('.first figcaption').map((caption) => caption.textContent);
  check('the method to take', captions[1].startsWith('light_buffer') && captions[1].includes('no wrong pixel'), captions[1]);
  check('the alternative', /^nsm .* % wrong.*blue lights a shadow, red shadows light/.test(captions[2]), captions[2]);
  check('both are those of the verdict', ['light_buffer', 'nsm'].every((name) => find('#verdict').textContent.includes(name)));
  const tops = images.map((image) => Math.round(image.getBoundingClientRect().top));
  check('side by side where there is room', innerWidth < 640 || new Set(tops).size === 1, tops);
  check('on the first screen', innerWidth < 1000 || images[2].getBoundingClientRect().bottom < 800, images[2].getBoundingClientRect().bottom);

  // One colour and mark of a method everywhere.
  const shapeOf = (svg) => svg.innerHTML;
  const inLegend = shapeOf(seen('#legend [data-method="nsm"] svg')[0]);
  for (const place of ['.first figcaption svg', '#table tr[data-label^="nsm"] svg']) {
    check(`the sign of nsm in ${place}`, seen(place).some((svg) => shapeOf(svg) === inLegend), place);
  }

  // The chart has a mark for each row, and a front.
  const marks = () => seen('#front .mark').map((mark) => mark.dataset.name);
  check('a mark for each row', marks().length === 7, marks());
  check('in one chart', seen('#front svg').length === 1, seen('#front svg').length);
  check('the front is drawn', seen('#front [stroke="var(--front)"]').length === 1);
  const names = () => seen('#front .name').map((name) => name.textContent);
  check('names beside marks', names().length >= 4 && names().every((name) => marks().includes(name)), names());
  const [chart] = seen('#front svg');
  check('as wide as its place', Math.abs(chart.getBoundingClientRect().width - find('#front').clientWidth) < 1);
  const letter = seen('#front .name')[0].getBoundingClientRect().height;
  check('names can be read', letter >= 11, letter);
  check('no text beyond the chart', seen('#front text').every((text) => {
    const [inner, outer] = [text.getBoundingClientRect(), chart.getBoundingClientRect()];
    return inner.left >= outer.left - 1 && inner.right <= outer.right + 1;
  }), seen('#front text').map((text) => text.textContent));
  const contrast = getComputedStyle(seen('#front text')[0]).fill !== getComputedStyle(find('section')).backgroundColor;
  check('words stand out', contrast && getComputedStyle(seen('#front text')[0]).fill === getComputedStyle(document.body).color);
  const bars = seen('#passes .bar > div').length;
  check('nothing is hidden at first', seen('#hidden').length === 0);
  find('#legend [data-method="nsm"]').click();
  check('the legend takes a method away', !marks().includes('nsm 64') && marks().length === 5, marks());
  check('its name', !names().includes('nsm 64'), names());
  check('its bars, too', seen('#passes .bar > div').length < bars || bars === 0, bars);
  check('its lines', seen('#growth [data-series="nsm"]').length === 0);
  check('and says of which methods the front is', seen('#hidden').length === 1);
  find('#legend [data-method="nsm"]').click();
  check('and brings it back', marks().length === 7, marks());
  find('#time [data-value="camera"]').click();
  check('the other time is drawn', seen('#front text').some((text) => text.textContent.includes('while the camera moves')));
  check('alone', seen('#front svg').length === 1, seen('#front svg').length);
  find('#time [data-value="frame"]').click();
  point(seen('#front .mark')[0], 'pointermove', 0.5, 0.5);
  check('a mark tells its figures', !find('#tip').hidden && find('#tip').textContent.includes('frame ms: '), find('#tip').textContent);
  check('in lines', find('#tip').textContent.split('\n').length >= 4, find('#tip').textContent);
  point(find('#front'), 'pointermove', 0.5, 0.5);
  check('and stops', find('#tip').hidden);
  seen('#front .mark')[0].focus();
  check('a focused mark tells them, too', !find('#tip').hidden);
  seen('#front .mark')[0].blur();

  // The table: whole where there is room, sorted, filtered.
  check('the table is whole', innerWidth < 1200 || find('#table').scrollWidth <= find('#table').clientWidth,
    `${find('#table').scrollWidth} of ${find('#table').clientWidth}`);
  check('a row each', rows().length === 7, rows());
  check('the best is marked', seen('tr.best').length === 1 && seen('tr.best')[0].children[2].textContent === '0', seen('tr.best').length);
  const wrong = () => cells('wrong outside band').map((text) => Number(text.replaceAll(',', '')));
  head('wrong outside band').firstChild.click();
  check('sorted upwards', wrong().every((value, index, list) => index === 0 || list[index - 1] <= value), wrong());
  head('wrong outside band').firstChild.click();
  check('sorted downwards', wrong().every((value, index, list) => index === 0 || list[index - 1] >= value), wrong());
  check('and says so', head('wrong outside band').ariaSort === 'descending');
  head('method').firstChild.click();
  check('by words', cells('method').every((text, index, list) => index === 0 || list[index - 1] <= text), cells('method'));
  head('memory').firstChild.click();
  const [least, most] = [cells('memory')[0], cells('memory').at(-1)];
  check('by bytes, whatever their prefix', least.endsWith('KiB') === most.endsWith('KiB') || least.endsWith('KiB'), cells('memory'));
  type('#filter', 'nsm 128');
  check('filtered by words', rows().join() === 'nsm 128', rows());
  type('#filter', '');
  find('#only-exact').click();
  check('only exact ones', rows().every((label) => /^(rt|light_buffer)/.test(label)) && rows().length === 3, rows());
  find('#only-exact').click();
  find('#all-tables').click();
  check('all sizes', rows().length === 14 && new Set(cells('of')).size === 2, rows());
  find('#all-tables').click();
  check('and this one again', rows().length === 7 && !head('of'), rows());

  // The pictures.
  const canvases = () => all('.stage canvas');
  check('two stages', canvases().length === 2);
  check('pictures are drawn', await until(() => colourAt(canvases()[0], 0.5, 0.5) !== '0 0 0 0'), colourAt(canvases()[0], 0.5, 0.5));
  set('#method-left', 'reference');
  set('#method-right', 'nsm 64');
  set('#kind-right', 'wrong pixels');
  await settled();
  check('a legend in the picture', all('.stage')[1].textContent.includes('wrongly lit'), all('.stage')[1].textContent);
  set('#kind-right', 'map texels per pixel');
  await settled();
  check('a scale of texels', all('.stage')[1].textContent.includes('64 or more'), all('.stage')[1].textContent);
  const figures = find('#viewer .figures').textContent;
  check('and their figures', figures.startsWith('nsm 64, texels per pixel: median '), figures);
  ['texels by distance', 'texels by angles'].forEach((kind) => set('#kind-right', kind));
  await settled();
  check('of their parts, too', find('#viewer .figures').textContent === figures);
  set('#kind-right', 'wrong pixels');
  await settled();
  check('which go with them', !find('#viewer .figures'));
  const whole = copy(canvases()[1]);
  point(canvases()[1], 'wheel', 0.3, 0.6, { deltaY: -700 });
  check('the wheel zooms', copy(canvases()[1]) !== whole && parseFloat(find('#zoom').textContent) > 4, find('#zoom').textContent);
  const near = copy(canvases()[1]);
  point(canvases()[1], 'pointerdown', 0.5, 0.5);
  point(canvases()[1], 'pointermove', 0.2, 0.4);
  point(canvases()[1], 'pointerup', 0.2, 0.4);
  check('dragging moves', copy(canvases()[1]) !== near);
  await until(() => find('#values').textContent.startsWith('pixel '));
  const values = find('#values').textContent;
  check('values of every picture', ['pixel ', 'reference', 'rt', 'nsm 64', 'light_buffer 128'].every((name) => values.includes(name)), values);
  check('in words', /lit|in shadow|facing away|background/.test(values), values);
  check('texels in numbers', /about [0-9.e-]+/.test(values), values);
  find('#zoom-fit').click();
  check('and all of it again', copy(canvases()[1]) === whole);
  check('single wrong pixels are seen from afar', await (async () => {
    const canvas = canvases()[1];
    const data = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
    let count = 0;
    for (let at = 0; at < data.length; at += 4) count += data[at] === 48 && data[at + 1] === 96 && data[at + 2] === 255;
    return count;
  })() >= 9);
  find('#mode [data-value="wipe"]').click();
  await settled();
  const one = canvases();
  check('one stage, wiped', one.length === 1 && find('#divider'));
  const before = copy(one[0]);
  find('#divider').dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowRight', bubbles: true }));
  check('the wipe moves by a key', copy(canvases()[0]) !== before && find('#divider').getAttribute('aria-valuenow') === '52');
  find('#mode [data-value="side"]').click();
  await settled();

  // Rows and marks by keyboard: one stop of Tab, arrows, Enter and the space bar.
  const stops = (selector) => seen(selector).filter((part) => part.tabIndex === 0);
  const press = (key) => document.activeElement.dispatchEvent(new KeyboardEvent('keydown', { key, bubbles: true, cancelable: true }));
  for (const [selector, key] of [['#table tbody tr', 'Enter'], ['#front .mark', ' ']]) {
    const of = (part) => part.dataset.label ?? part.dataset.name;
    check(`one stop among ${selector}`, stops(selector).length === 1, stops(selector).length);
    stops(selector)[0].focus();
    press('Home');
    const before = of(document.activeElement);
    press('ArrowDown');
    const after = of(document.activeElement);
    check(`arrows move among ${selector}`, before !== after && stops(selector).length === 1, `${before} ${after}`);
    press(key);
    check(`${key} chooses of ${selector}`, seen('#table tr[aria-current]').map(of).join() === after, after);
  }
  const unnamed = seen('button, select, input, canvas, [tabindex]').filter((part) => part.tagName !== 'TR'
    && !(part.ariaLabel || part.textContent.trim() || part.labels?.length || part.querySelector('img')?.alt));
  check('all controls have names', unnamed.length === 0, unnamed.map((part) => part.outerHTML.slice(0, 80)));

  // A click on a row shows its picture.
  seen('#table tr[data-label="nsm 128"]')[0].click();
  await settled();
  const chosen = seen('#front .mark.chosen').map((mark) => mark.dataset.name);
  check('a row’s mark', chosen.join() === 'nsm 128', chosen);
  check('a row’s picture', find('#method-right').selectedOptions[0].text === 'nsm 128', find('#method-right').selectedOptions[0].text);

  // The verdict's pictures open in the viewer.
  first()[2].click();
  await settled();
  check('a picture opens', find('#kind-right').selectedOptions[0].text === 'wrong pixels'
    && find('#method-right').selectedOptions[0].text.startsWith('nsm'), find('#method-right').selectedOptions[0].text);

  // Passes, growth, graph, conditions.
  check('bars', seen('#passes .step').length > 10, seen('#passes .step').length);
  check('growth by viewport and map', seen('#growth svg').length === 2, seen('#growth svg').length);
  set('#graph-method', 'light_buffer');
  await settled();
  check('a graph', find('#graph img').naturalWidth > 300, find('#graph img').naturalWidth);
  check('the command', find('#conditions pre').textContent.startsWith('skiagraph compare rt nsm'), find('#conditions').textContent);
  check('no hard cases', find('#stress-section').hidden);

  // The link holds what is chosen, and brings it back.
  await settled();
  check('the link tells what is chosen', location.hash.includes('row=') && location.hash.includes('picture=error+nsm'), location.hash);
  const link = '#table=0&time=camera&hide=pcf&row=nsm+128&sort=memory&down=true&filter=nsm&theme=dark'
    + '&picture=visibility+reference&picture=shaded+nsm+64&mode=wipe&wipe=0.25';
  location.hash = link;
  await settled();
  check('a link’s rows', rows().length === 2 && rows().every((label) => label.startsWith('nsm')), rows());
  check('sorted', head('memory').ariaSort === 'descending', head('memory').ariaSort);
  check('and its row', seen('#table tr[aria-current]')[0]?.dataset.label === 'nsm 128');
  check('its marks', !marks().some((name) => name.startsWith('pcf')) && find('#time [aria-pressed="true"]').dataset.value === 'camera');
  check('its pictures', find('#method-right').selectedOptions[0].text === 'nsm 64' && find('#divider')?.ariaValueNow === '25', find('#method-right').selectedOptions[0].text);
  check('its theme', document.documentElement.dataset.theme === 'dark');
  location.hash = '#table=7&hide=nothing&row=none&sort=up&view=no&picture=a&wipe=4&zoom=x&theme=pink&other=1';
  await settled();
  check('what a link has wrong is passed over', rows().length === 7 && marks().length === 7 && location.hash === '', location.hash);
  check('no row is chosen', seen('#table tr[aria-current]').length === 0);

  // Another size, the other theme.
  check('graded answers stand beside hard ones', rows().includes('pcf 64') && rows().includes('nsm 64'), rows());
  check('and all have an RMSE', cells('RMSE').every((text) => Number(text) >= 0), cells('RMSE'));
  set('#table-choice', [...find('#table-choice').options].map((option) => option.text).find((text) => text.includes('96x64')));
  await settled();
  check('the other size', rows().includes('light_buffer 128') && marks().length > 0);
  const theme = document.documentElement.dataset.theme;
  const paper = getComputedStyle(document.body).backgroundColor;
  find('#theme').click();
  check('the other theme', getComputedStyle(document.body).backgroundColor !== paper);
  find('#theme').click();
  check('and back', document.documentElement.dataset.theme === theme);
} catch (error) {
  failed.push(String(error.stack));
}
done();
