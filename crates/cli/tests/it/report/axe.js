// Critical and serious findings of axe-core on the whole page, and whether it scrolls sideways.
let passed = 0;
try {
  await settled();
  await new Promise((loaded, broken) => {
    const script = document.createElement('script');
    [script.src, script.onload, script.onerror] = ['../axe.min.js', loaded, broken];
    document.head.append(script);
  });
  check('the page does not scroll sideways', document.documentElement.scrollWidth <= innerWidth,
    `${document.documentElement.scrollWidth} of ${innerWidth}`);
  const { violations, passes } = await axe.run(document);
  passed = passes.length;
  for (const { id, impact, help, nodes } of violations.filter((one) => ['critical', 'serious'].includes(one.impact))) {
    const where = nodes.slice(0, 5).map(({ target, failureSummary }) => `${target.join(' ')} (${failureSummary})`);
    failed.push(`${impact} ${id}, ${help}, ${nodes.length} times: ${where.join('; ')}`);
  }
} catch (error) {
  failed.push(String(error.stack ?? error));
}
done({ passed });
