// Two machines and the hard cases in one page.
try {
  await settled();
  const choices = [...find('#table-choice').options].map((option) => option.text);
  check('both machines', choices.some((text) => text.includes('Far GPU')) && choices.some((text) => text.includes('llvmpipe')), choices);
  check('no overview of one scene', seen('#overview-section').length === 0);
  find('#all-tables').click();
  check('rows of both', cells('of').some((text) => text.includes('Far GPU')), cells('of'));
  check('the matrix', find('#stress').textContent.includes('box_on_floor'), find('#stress').textContent);
  const [good, bad] = all('#stress table');
  check('its promise holds', good.querySelectorAll('td.pass').length > 0 && good.querySelectorAll('td.fail').length === 0);
  check('a cell tells more', good.querySelector('td.unjudged').title.includes('uncertain'), good.innerHTML);
  check('a band that is too large fails', bad.querySelector('td.fail').textContent.startsWith('✗'), bad.textContent);
  check('and is said', find('#stress .warning').textContent.includes('1,000 pixels in the band'), find('#stress').textContent);
  check('as is who could not run', find('#stress').textContent.includes('is unavailable: needs what is not there'));
  // A band of more than a thousandth.
  const far = choices.find((text) => text.includes('Far GPU'));
  set('#table-choice', far);
  await settled();
  const warning = all('#facts .warning').at(-1);
  check('the band is warned of', warning?.textContent.startsWith('warning: the band is larger than 0.1 %'), find('#facts').textContent);
  check('where it is seen', warning?.getBoundingClientRect().height > 10 && warning.getBoundingClientRect().top < 600);
  check('with the pixels that face the light', find('#facts').textContent.includes('facing the light'), find('#facts').textContent);
  check('where from', find('#conditions').textContent.includes('far'), find('#conditions').textContent);
} catch (error) {
  failed.push(String(error.stack));
}
done();
