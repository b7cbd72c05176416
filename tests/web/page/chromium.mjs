// Debian's chromium as tests start it: without a graphics card and without network requests of its own.

export const program_of_chromium = process.env.COPPICE_CHROMIUM ?? '/usr/bin/chromium';
export const arguments_of_chromium = ['--headless', '--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run',
  '--disable-background-networking', '--disable-component-update', '--disable-sync'];
