// Two machines and the hard cases in one page.
try {
  await settled();
  const choices = [...find('#table-choice').options].map((option) => option.text);
  check('both machines', choices.some((text) => text.includes('Far GPU')) && choices.some((text) => text.includes('llvmpipe')), choices);
  find('#all-tables').click();
  check('rows of both', cells(1).some((text) => text.includes('Far GPU')), cells(1));
  check('the matrix', find('#stress').textContent.includes('box_on_floor'), find('#stress').textContent);
  check('its promise holds', all('#stress td.pass').length > 0 && all('#stress td.fail').length === 0);
  check('where from', find('#conditions').textContent.includes('far'), find('#conditions').textContent);
} catch (error) {
  failed.push(String(error.stack));
}
done();
