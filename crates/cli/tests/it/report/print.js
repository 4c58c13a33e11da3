// A page as it is printed on A4 paper: the rules of its style for paper, in a frame as wide.
try {
  await settled();
  for (const rule of [...document.styleSheets].flatMap((sheet) => [...sheet.cssRules])) {
    if (rule.media?.mediaText === 'print') rule.media.mediaText = 'all';
    else if (rule.media?.mediaText === 'screen') rule.media.mediaText = 'not all';
  }
  await settled();
  const beyond = seen('main *, header *').filter((part) => part.getBoundingClientRect().right > innerWidth + 1);
  check('nothing is cut at the right edge', beyond.length === 0, beyond.map((part) => part.outerHTML.slice(0, 80)));
  check('nothing scrolls', seen('.wide').every((part) => part.scrollWidth <= part.clientWidth));
  check('nothing to click', seen('.controls, #theme').length === 0);
  check('a note on what is left out', seen('#printed')[0]?.textContent.startsWith('Printed for '));
  check('dark on light', getComputedStyle(document.body).color === 'rgb(29, 33, 38)', getComputedStyle(document.body).color);
} catch (error) {
  failed.push(String(error.stack));
}
done();
