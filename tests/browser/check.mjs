// Runs checks one after the other and counts those that fail. only: the name of one.
export function checker(only) {
  let failed = 0;
  const check = async (name, work) => {
    if (only && only !== name) return;
    const start = Date.now();
    try {
      await work();
      console.log(`ok   ${name} (${((Date.now() - start) / 1000).toFixed(1)} s)`);
    } catch (error) {
      failed++;
      console.log(`FAIL ${name}\n     ${String(error?.stack ?? error).replaceAll('\n', '\n     ')}`);
    }
  };
  return {check, failed: () => failed};
}
