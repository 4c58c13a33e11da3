// One folder's page: chart, sort, filter, wipe, zoom.
try {
  await settled();
  check('nothing is wider than the window', document.documentElement.scrollWidth <= innerWidth,
    `${document.documentElement.scrollWidth} of ${innerWidth}`);
  check('a verdict', find('#verdict').textContent.includes('light_buffer'), find('#verdict').textContent);

  // The chart has a mark for each row, and a front.
  const marks = () => all('#front .mark').map((mark) => mark.dataset.label);
  check('a mark for each row', marks().length === 5, marks());
  check('the front is drawn', find('#front .pareto'));
  check('no text beyond the chart', all('#front text').every((text) => {
    const [inner, outer] = [text.getBoundingClientRect(), find('#front svg').getBoundingClientRect()];
    return inner.left >= outer.left - 1 && inner.right <= outer.right + 1;
  }), all('#front text').map((text) => text.textContent));
  find('#legend [data-method="nsm"]').click();
  check('the legend takes a method away', !marks().includes('nsm 64') && marks().length === 3, marks());
  find('#legend [data-method="nsm"]').click();
  check('and brings it back', marks().length === 5, marks());
  find('#time [data-value="kept"]').click();
  check('the other time is drawn', find('#front').textContent.includes('only the camera moves'));
  find('#time [data-value="frame"]').click();
  point(find('#front .mark'), 'pointermove', 0.5, 0.5);
  check('a mark tells its figures', !find('#tip').hidden && find('#tip').textContent.includes('ms a frame'), find('#tip').textContent);
  point(find('#front .mark'), 'pointerleave', 0.5, 0.5);
  check('and stops', find('#tip').hidden);

  // The table: sorted, filtered.
  check('a row each', rows().length === 5, rows());
  check('the best is marked', all('tr.best').length === 1 && find('tr.best').children[1].textContent === '0', all('tr.best').length);
  const wrong = () => cells(1).map((text) => Number(text.replaceAll(',', '')));
  find('#table th[data-key="wrong"] button').click();
  check('sorted upwards', wrong().every((value, index, list) => index === 0 || list[index - 1] <= value), wrong());
  find('#table th[data-key="wrong"] button').click();
  check('sorted downwards', wrong().every((value, index, list) => index === 0 || list[index - 1] >= value), wrong());
  check('and says so', find('#table th[data-key="wrong"]').getAttribute('aria-sort') === 'descending');
  type('#filter', 'nsm 128');
  check('filtered by words', rows().join() === 'nsm 128', rows());
  type('#filter', '');
  find('#only-exact').click();
  check('only exact ones', rows().every((label) => /^(rt|light_buffer)/.test(label)) && rows().length === 3, rows());
  find('#only-exact').click();
  find('#all-tables').click();
  check('all sizes', rows().length === 10, rows());
  find('#all-tables').click();

  // The pictures.
  const canvases = () => all('.stage canvas');
  check('two stages', canvases().length === 2);
  check('pictures are drawn', await until(() => colourAt(canvases()[0], 0.5, 0.5) !== '0 0 0 0'), colourAt(canvases()[0], 0.5, 0.5));
  set('#method-left', 'reference');
  set('#method-right', 'nsm 64');
  set('#kind-right', 'wrong pixels');
  await settled();
  check('the legend tells rings from wrong pixels', all('.stage')[1].textContent.includes('ring: around lone wrong pixels'));
  check('a legend in the picture', all('.stage')[1].textContent.includes('wrongly lit'), all('.stage')[1].textContent);
  const whole = copy(canvases()[1]);
  point(canvases()[1], 'wheel', 0.3, 0.6, { deltaY: -700 });
  check('the wheel zooms', copy(canvases()[1]) !== whole && parseFloat(find('#zoom').textContent) > 4, find('#zoom').textContent);
  const near = copy(canvases()[1]);
  point(canvases()[1], 'pointerdown', 0.5, 0.5);
  point(canvases()[1], 'pointermove', 0.2, 0.4);
  point(canvases()[1], 'pointerup', 0.2, 0.4);
  check('dragging moves', copy(canvases()[1]) !== near);
  await until(() => find('#values table'));
  const values = find('#values').textContent;
  check('values of every picture', ['pixel ', 'reference', 'rt', 'nsm 64', 'light_buffer 128'].every((name) => values.includes(name)), values);
  check('in words', /lit|in shadow|facing away|background/.test(values), values);
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

  // A click on a row shows its picture.
  find('#table tr[data-label="nsm 128"]').click();
  await settled();
  check('a row’s picture', find('#method-right').selectedOptions[0].text === 'nsm 128', find('#method-right').selectedOptions[0].text);

  // Passes, growth, graph, conditions.
  check('bars', all('#passes .step').length > 10, all('#passes .step').length);
  check('growth by viewport and map', all('#growth svg').length === 2, all('#growth svg').length);
  set('#graph-method', 'light_buffer');
  await settled();
  check('a graph', find('#graph img').naturalWidth > 300, find('#graph img').naturalWidth);
  check('the command', find('#conditions pre').textContent.startsWith('skiagraph compare rt nsm'), find('#conditions').textContent);
  check('no hard cases', find('#stress-section').hidden);

  // Graded answers, another size, the other theme.
  set('#table-choice', [...find('#table-choice').options].map((option) => option.text).find((text) => text.includes('graded')));
  await settled();
  check('graded answers have an RMSE', rows().join() === 'pcf 64,pcf 128' || rows().join() === 'pcf 128,pcf 64', rows());
  check('and marks', all('#front .mark').length === 2 && find('#table th[data-key="rmse"]'), all('#front .mark').length);
  set('#table-choice', [...find('#table-choice').options].map((option) => option.text).find((text) => text.includes('96x64')));
  await settled();
  check('the other size', find('#table').textContent.includes('light_buffer 128') && all('#front .mark').length > 0);
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
