// Debian's Chromium, headless, drawing with Mesa's llvmpipe.
import { existsSync } from 'node:fs';

const chromium = process.env.CHROMIUM ?? '/usr/bin/chromium';

// Calls work(browser) and closes the browser. Without a browser the test is skipped: exit 77.
export async function withBrowser(work) {
  if (!existsSync(chromium)) {
    console.log(`skipped: no ${chromium}; scripts/setup --browser installs it`);
    process.exit(77);
  }
  const playwright = await import('playwright-core');
  const browser = await playwright.chromium.launch({
    executablePath: chromium,
    args: ['--no-sandbox', '--use-gl=angle', '--use-angle=gl-egl', '--ignore-gpu-blocklist'],
    env: { ...process.env, LIBGL_ALWAYS_SOFTWARE: '1' },
  });
  try {
    return await work(browser);
  } finally {
    await browser.close();
  }
}
