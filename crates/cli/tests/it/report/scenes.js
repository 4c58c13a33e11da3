// Two scenes in one page, in two sizes each.
try {
  await settled();
  const heads = all('#overview table').map((table) => [...table.querySelectorAll('thead th')].map((cell) => cell.textContent).join(' '));
  check('a column for each scene', heads.join() === 'method park level,method park level', heads);
  check('a verdict on each', ['park at 64x64: ', 'level at 96x64: '].every((text) => find('#overview').textContent.includes(text)), find('#overview').textContent);
  check('names are names', find('#overview p code') !== null);
  const link = all('#overview a').at(-1);
  link.click();
  await settled();
  const chosen = find('#table-choice').selectedOptions[0].text;
  check('a cell leads to its scene', chosen.startsWith('level') && chosen.includes('96x64'), chosen);
  check('and to its rows', rows().length > 0 && find('#scene').textContent.includes('level'), find('#scene').textContent);
  const top = (selector) => find(selector).getBoundingClientRect().top;
  check('the overview comes first', top('#overview') < top('#scene') && top('#scene') < top('#verdict'));
} catch (error) {
  failed.push(String(error.stack));
}
done();
